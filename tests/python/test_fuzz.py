# SPDX-License-Identifier: Apache-2.0
"""Wrong arguments of everything callable, the compiled module included: exceptions that say what was expected, and never a dead interpreter.

More cases: ``python tests/python/fuzz_bindings.py --cases 50000 --seed 3``, or AUREOLE_FUZZ_CASES and AUREOLE_FUZZ_SEED for this test.
"""
import json
import os

import fuzz_bindings
from effort import effort


def test_wrong_arguments():
    cases, seed = int(os.environ.get("AUREOLE_FUZZ_CASES", effort(600, 2000))), int(os.environ.get("AUREOLE_FUZZ_SEED", 1))
    results = fuzz_bindings.run(cases, seed, jobs=2, batch=250)
    assert len(results) >= cases
    assert sum(what == "result" for _, _, what in results) > 0.1 * cases  # else nothing deep is reached
    assert not fuzz_bindings.failures_text(results, seed)


def test_all_public_callables_are_called():
    names = {name for name, *_ in fuzz_bindings.targets()}
    assert {"aureole.render", "aureole.Scene.__setitem__", "aureole.Bsdf.eval", "aureole.optics.mie", "aureole.plot.corona",
            "aureole.Transform.look_at", "_aureole.OpenScene.set", "_aureole.count_pairs"} <= names


def test_the_fuzzer_sees_what_is_wrong(monkeypatch):
    kinds = {"os.abort()": "crash", "os._exit(3)": "crash", "os.kill(os.getpid(), signal.SIGSEGV)": "crash", "spin()": "hang",
             "throw(RuntimeError('std::bad_cast'))": "exception", "throw(ValueError('operands could not be broadcast'))": "message",
             "optics.mie(-1, 1.5)": "", "np.ones(2**40)": ""}
    monkeypatch.setenv("AUREOLE_FUZZ_INSTEAD", json.dumps(list(kinds)))
    monkeypatch.setattr(fuzz_bindings, "SOFT_S", 0.2)
    monkeypatch.setattr(fuzz_bindings, "HARD_S", 0.5)
    results = fuzz_bindings.run(len(kinds), 1, jobs=1)
    assert [(number, found) for number, found, _ in results] == list(enumerate(kinds.values())), results
