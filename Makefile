# SPDX-License-Identifier: Apache-2.0
# The commands of the project; each does all the set-up it needs. JOBS limits parallel compilation.
JOBS ?= $(shell nproc)
PRESET ?= release
PYTHON ?= python3
BIN = build/$(PRESET)/bin/aureole
DEMO_OUT ?= out/condensation
# Adaptive samples: a better picture in 0.6 of the time of 256 equal ones. The lamps are 10^5 times as bright
# as the street.
DEMO_ARGS ?= --spp 160 --adaptive display --tonemap asinh:12:-1
N ?= 10000
TSAN_TESTS ?= ^(Determinism|RenderState|FilmBuffer|EditedSceneByHand)
SEED ?= $(shell tools/with_fuzz_seed.sh)
export CCACHE_MAXSIZE ?= 2G

.PHONY: deps build program demo test test-asan test-tsan fuzz bench bench-peers docs format format-check includes words lint lint-all install wheel wheels wheel-test clean

deps:
	@tools/install_deps.sh

build: deps
	@cmake --preset $(PRESET) > build-configure.log 2>&1 || { cat build-configure.log; exit 1; }
	@rm -f build-configure.log
	cmake --build --preset $(PRESET) -j $(JOBS)

# Compiles the program alone, without tests and Python module.
program:
	@tools/install_deps.sh program
	@test -f build/$(PRESET)/build.ninja || cmake --preset $(PRESET) -DAUREOLE_PYTHON=OFF -DBUILD_TESTING=OFF > build-configure.log 2>&1 || { cat build-configure.log; exit 1; }
	@rm -f build-configure.log
	cmake --build --preset $(PRESET) -j $(JOBS) --target aureole

demo: program
	@mkdir -p $(dir $(DEMO_OUT))
	$(BIN) render scenes/condensation/condensation.xml -o $(DEMO_OUT).exr --restart $(DEMO_ARGS)
	@echo "The picture is $(abspath $(DEMO_OUT).png)"
	@$(BIN) rings $(DEMO_OUT).exr

test: build
	ctest --preset $(PRESET) -j $(JOBS) $(CTEST_ARGS)

test-asan:
	$(MAKE) test PRESET=asan

test-tsan:
	$(MAKE) build PRESET=tsan
	TSAN_OPTIONS=ignore_noninstrumented_modules=1 ctest --preset tsan -j $(JOBS) -R '$(TSAN_TESTS)' $(CTEST_ARGS)

# make fuzz N=50000 SEED=3 PRESET=asan; without SEED that of the commit
fuzz: deps
	@cmake --preset $(PRESET) > build-configure.log 2>&1 || { cat build-configure.log; exit 1; }
	@rm -f build-configure.log
	cmake --build --preset $(PRESET) -j $(JOBS) --target aureole_fuzz
	build/$(PRESET)/bin/aureole_fuzz --cases $(N) --seed $(SEED) --jobs $(JOBS) --folder build/$(PRESET)/fuzz

bench: deps
	@cmake -S . -B build/bench -G Ninja -DCMAKE_BUILD_TYPE=Release -DAUREOLE_BENCH=ON -DBUILD_TESTING=OFF > /dev/null
	cmake --build build/bench -j $(JOBS)
	@bench/run.sh build/bench/bin

bench-peers: build
	@$(PYTHON) bench/peers.py --aureole $(BIN) $(PEERS_ARGS)

docs: build
	$(BIN) docs > docs/plugins.md

format:
	@git ls-files -co --exclude-standard '*.h' '*.cpp' | xargs clang-format -i

format-check: deps
	@git ls-files -co --exclude-standard '*.h' '*.cpp' | xargs clang-format --dry-run -Werror && echo "clang-format: clean"

includes:
	@tools/check_includes.py .

# make words WORDS_ARGS=--count; WORDS_ARGS="src/aureole/bsdf docs/media.md" checks these alone.
words:
	@tools/check_words.py --root . $(WORDS_ARGS)

# ruff and shellcheck, and clang-tidy on C++ that differs from LINT_BASE (default: main); a tool that is not installed is passed over.
lint:
	@tools/lint_changed.sh $(LINT_BASE)

# clang-tidy on all sources of the library and the programs.
lint-all: build
	@command -v clang-tidy > /dev/null || { echo "lint-all needs clang-tidy: apt-get install clang-tidy"; exit 1; }
	@cmake --preset $(PRESET) -B build/lint -DAUREOLE_BATCHES=OFF > /dev/null
	@git ls-files 'src/*.cpp' 'apps/*.cpp' | xargs -P $(JOBS) -n 4 clang-tidy -p build/lint --quiet

install: build
	cmake --install build/$(PRESET) --prefix $(or $(PREFIX),/usr/local)

wheel: deps
	@tools/make_wheel.sh dist

# Wheels for CPython 3.9 to 3.11, each, and for 3.12 and later.
wheels:
	@tools/make_wheels.sh dist

# Installs the wheels of dist in a bare Debian that debootstrap makes, and uses them there (needs root; not a part of `make test`).
wheel-test:
	@$(PYTHON) tests/python/wheels_in_bare_root.py dist build/bare-root $(BIN)

clean:
	rm -rf build out dist
