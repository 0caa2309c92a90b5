# SPDX-License-Identifier: Apache-2.0
"""Mitsuba in a process of its own, for peers.py.

    peers_mitsuba.py check                            can the LLVM variant compile? prints LLVM's version
    peers_mitsuba.py serve VARIANT THREADS            renders what is asked on stdin, a JSON object a line; `eradiate` is
                                                      eradiate-mitsuba's spectral variant, with its bounds of grids
    peers_mitsuba.py load THREADS FILE [render]       times reading a file, or reading it and rendering its first pixels
"""
import json
import os
import signal
import sys
import time
import traceback

LLVM = "llvm_ad_spectral"


def start(variant, threads):
    import drjit as dr
    import mitsuba as mi
    mi.set_variant(variant)
    mi.set_log_level(mi.LogLevel.Error)
    dr.set_thread_count(threads)
    return dr, mi


def check():
    dr, mi = start(LLVM, 2)
    x = dr.arange(mi.Float, 64) * 2
    dr.eval(x)
    assert x[63] == 126
    version = getattr(dr.detail, "llvm_version", lambda: "?")()
    print(".".join(map(str, version)) if isinstance(version, tuple) else version)


class Server:
    def __init__(self, variant, threads):
        self.eradiate = variant == "eradiate"
        if self.eradiate:
            variant = "llvm_ad_spectral_polarized"  # its only vectorised spectral one
        self.dr, self.mi = start(variant, threads)
        self.jit, self.threads = variant.startswith("llvm"), threads
        self.scenes, self.warm = {}, set()
        # Says for each render whether a kernel was compiled.
        if self.jit:
            self.dr.set_flag(self.dr.JitFlag.KernelHistory, True)

    def scene(self, file, defines, sampler):
        """The scene as mi.load_file makes it, but with another sampler."""
        mi = self.mi
        key = file, tuple(sorted(defines.items())), sampler
        if key not in self.scenes and self.eradiate:
            import peers_eradiate
            self.scenes[key] = peers_eradiate.load(mi, file, defines, sampler)
        elif key not in self.scenes:
            mi.file_resolver().prepend(os.path.dirname(file))
            config = mi.parser.ParserConfig(mi.variant())
            state = mi.parser.parse_file(config, file, **defines)
            samplers = [n for n in state.nodes if n.type == mi.ObjectType.Sampler]
            if len(samplers) != 1:
                raise RuntimeError(f"{file}: {len(samplers)} samplers, expected one")
            samplers[0].props.set_plugin_name(sampler)
            mi.parser.transform_all(config, state)
            # With one thread Mitsuba 3.9.1 waits for ever when it reads an EXR.
            self.dr.set_thread_count(max(2, self.threads))
            made = mi.parser.instantiate(config, state)
            self.dr.set_thread_count(self.threads)
            self.scenes[key] = made[0] if isinstance(made, (list, tuple)) else made
        return self.scenes[key]

    def timed(self, scene, spp, seed):
        """A picture, its seconds, and whether something was compiled meanwhile."""
        dr = self.dr
        if self.jit:
            dr.kernel_history_clear()
        begin = time.perf_counter()
        picture = self.mi.render(scene, spp=spp, seed=seed)
        if self.jit:
            dr.eval(picture)
            dr.sync_thread()
        seconds = time.perf_counter() - begin
        compiled = self.jit and any(not k.get("cache_hit", True) for k in dr.kernel_history())
        return picture, seconds, compiled

    def render(self, file, defines, sampler, spp, seed, output):
        import numpy as np
        scene = self.scene(file, defines, sampler)
        counter = scene.sensors()[0].sampler().clone()
        counter.set_sample_count(spp)
        # Kernels depend on the number of samples (the first render of one compiles), not on the seed.
        warm = file, tuple(sorted(defines.items())), sampler, spp
        if self.jit and warm not in self.warm:
            self.timed(scene, spp, seed + 1_000_000)
            self.warm.add(warm)
        for _ in range(3):
            picture, seconds, compiled = self.timed(scene, spp, seed)
            if not compiled:
                break
        else:
            raise RuntimeError(f"{sampler}, {spp} samples per pixel: compiles again for every picture")
        np.save(output, np.array(picture, dtype=np.float32)[..., :3])
        return {"seconds": seconds, "spp": counter.sample_count()}

    def run(self, replies):
        for line in sys.stdin:
            try:
                reply = self.render(**json.loads(line))
            except Exception:
                reply = {"error": traceback.format_exc()}
            print(json.dumps(reply), file=replies, flush=True)


def load(threads, file, render):
    dr, mi = start(LLVM, max(2, threads))
    import numpy as np
    begin = time.perf_counter()
    loaded = mi.load_file(file)
    if render:
        np.array(mi.render(loaded, spp=1, seed=0))
    dr.sync_thread()
    return {"seconds": time.perf_counter() - begin}


def main():
    command, *rest = sys.argv[1:]
    if command == "check":
        return check()
    # Mitsuba logs to stdout, where the parent expects answers only.
    replies = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    if command == "serve":
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends this process
        Server(rest[0], int(rest[1])).run(replies)
    else:
        print(json.dumps(load(int(rest[0]), rest[1], rest[2:] == ["render"])), file=replies, flush=True)


if __name__ == "__main__":
    main()
