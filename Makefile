# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

# Each target installs what it needs and is missing; a second run does only what has changed.

PYTHON ?= python3

build_packages = build-essential cmake ninja-build python3-dev python3-venv libembree-dev
demo_packages = $(build_packages) assimp-testmodels
bench_packages = $(demo_packages) libllvm19
test_packages = $(demo_packages) libcmocka-dev libopenimageio-dev pkg-config chromium chromium-driver
clang_packages = $(build_packages) libcmocka-dev clang

sources = CMakeLists.txt pyproject.toml $(shell find cmake csrc python -type f -not -name '*.pyc')
venv = .venv/bin/python

# Mitsuba, for bench, in an environment of its own that sees this package, with an LLVM it accepts.
MITSUBA_PYTHON = build/mitsuba/bin/python
with_llvm = DRJIT_LIBLLVM_PATH=$$(ls /usr/lib/*/libLLVM.so.19* 2>/dev/null | head -n 1)
with_mitsuba = $(with_llvm) PYTHONPATH=$$($(venv) -c 'import sysconfig; print(sysconfig.get_path("platlib"))') $(MITSUBA_PYTHON)

.PHONY: help demo test sanitize clang differential lint docs bench bench-peers battery gallery clean packages-demo packages-test packages-bench packages-clang build-c
.DELETE_ON_ERROR:
.NOTPARALLEL: # packages come first; CMake and pip use all processors themselves

help:
	@echo "make demo      renders pictures to a stated tolerance into out/"
	@echo "make test      builds everything, runs the C and the Python tests, builds the site"
	@echo "make sanitize  runs the C tests under AddressSanitizer with UBSan, then ThreadSanitizer"
	@echo "make clang     builds core and render by clang, warnings as errors, and runs the C tests of core"
	@echo "make differential  compares 2,000 random scenes with a plain path tracer; scenes=N and first=SEED are others"
	@echo "make lint      ruff, mypy --strict, warnings as errors, clang-format"
	@echo "make docs      builds the site into build/site/, which needs no network to be read"
	@echo "make bench     measures speed and accuracy; figures go to standard output"
	@echo "make bench-peers  measures seconds to a stated error beside Mitsuba, Cycles and LuxCore"
	@echo "make battery   tests every generator's structure and runs dieharder; writes the tables of docs/generators.md"
	@echo "make gallery   writes docs/gallery.md and its pictures anew"
	@echo "make clean     removes build/, out/, dist/ and .venv/"

demo: packages-demo .venv/.demo
	$(venv) examples/demo.py

test: packages-test build-c .venv/.test
	ctest --test-dir build --output-on-failure
	$(venv) -m pytest
	@$(MAKE) --no-print-directory docs

sanitize: packages-test
	for kind in address,undefined thread; do \
	    CMAKE_GENERATOR=Ninja cmake -S . -B build/$$kind -D CMAKE_BUILD_TYPE=Release -D SUNFLECK_SANITIZE=$$kind \
	        -D SUNFLECK_BUILD_IMAGE=OFF && \
	    cmake --build build/$$kind --parallel && \
	    ctest --test-dir build/$$kind --output-on-failure || exit 1; \
	done

clang: packages-clang
	CMAKE_GENERATOR=Ninja cmake -S . -B build/clang -D CMAKE_BUILD_TYPE=Release -D CMAKE_COMPILE_WARNING_AS_ERROR=ON \
	    -D CMAKE_C_COMPILER=clang -D CMAKE_CXX_COMPILER=clang++ -D SUNFLECK_BUILD_IMAGE=OFF -D SUNFLECK_INSTALL=OFF
	cmake --build build/clang --parallel
	ctest --test-dir build/clang --output-on-failure -L core

# Some 40 minutes of two processors; Ctrl-C ends with a report of the scenes so far.
scenes = 2000
first = 1000000
differential: packages-demo .venv/.test
	$(venv) tests/differential/run.py --scenes $(scenes) --first $(first)

lint: .venv/.lint build-c
	.venv/bin/ruff check .
	.venv/bin/ruff format --check .
	.venv/bin/mypy
	scripts/check-format.sh
	scripts/check-layers.py build

docs: packages-demo .venv/.docs
	rm -rf build/site build/site-read docs/reference
	$(venv) -m sphinx -W --keep-going -q -b html -d build/site-read docs build/site
	@echo "build/site/index.html"

bench: packages-bench .venv/.test build/reference/penumbra_256.npy build/reference/cornell_256.npy
	$(with_mitsuba) bench/render_speed.py
	$(venv) bench/package_startup.py
	$(venv) bench/points_rate.py
	$(venv) bench/rng_rate.py
	$(venv) bench/quality_chart.py
	$(venv) bench/render_instances.py
	$(venv) bench/points_which_pattern.py

# Some ten minutes; results add up in build/peers/results.json, and `render_peers.py report` shows them.
peers = build/reference/penumbra_256.npy build/reference/defocus_256.npy build/reference/cornell_256.npy
bench-peers: packages-bench .venv/.test $(MITSUBA_PYTHON) build/cycles/bin/python build/luxcore/bin/python $(peers)
	for scene in penumbra defocus cornell; do \
	    $(with_llvm) $(venv) bench/peers_render.py measure $$scene && \
	    $(with_llvm) $(venv) bench/peers_render.py start $$scene || exit 1; \
	done
	$(venv) bench/peers_render.py report
	$(venv) bench/render_scaling.py threads
	$(venv) bench/render_scaling.py memory

# Half a minute for the structure, then some 15 minutes of two processors; build/battery/ keeps what was run.
battery: packages-demo .venv/.test
	@scripts/install-packages.sh dieharder
	$(venv) bench/rng_structure.py
	$(venv) bench/rng_battery.py

gallery: packages-demo .venv/.test
	$(venv) scripts/make-gallery.py

clean:
	rm -rf build out dist docs/reference .venv .pytest_cache .mypy_cache .ruff_cache

packages-demo:
	@scripts/install-packages.sh $(demo_packages)

packages-bench:
	@scripts/install-packages.sh $(bench_packages)

packages-clang:
	@scripts/install-packages.sh $(clang_packages)

packages-test:
	@scripts/install-packages.sh $(test_packages)

# The generator is taken from the environment only where build/ is new. werror=OFF lets warnings of another compiler be.
werror = ON
build-c: packages-test
	CMAKE_GENERATOR=Ninja cmake -S . -B build -D CMAKE_BUILD_TYPE=Release -D CMAKE_COMPILE_WARNING_AS_ERROR=$(werror)
	cmake --build build --parallel

.venv/.created:
	$(PYTHON) -m venv .venv
	touch $@

# The wheel is built once and installed with what each target needs besides.
build/wheel/.built: $(sources) | .venv/.created
	rm -rf build/wheel
	$(venv) -m pip wheel -q --no-deps --wheel-dir build/wheel .
	touch $@

.venv/.demo: build/wheel/.built
	$(venv) -m pip install -q --force-reinstall --no-deps build/wheel/*.whl
	$(venv) -m pip install -q build/wheel/*.whl
	touch $@

.venv/.test: .venv/.demo
	$(venv) -m pip install -q "$$(echo build/wheel/*.whl)[test]"
	touch $@

.venv/.docs: .venv/.demo
	$(venv) -m pip install -q "$$(echo build/wheel/*.whl)[docs]"
	touch $@

.venv/.lint: .venv/.test
	$(venv) -m pip install -q "$$(echo build/wheel/*.whl)[lint]"
	touch $@

$(MITSUBA_PYTHON):
	$(PYTHON) -m venv build/mitsuba
	$(MITSUBA_PYTHON) -m pip install -q mitsuba

# Cycles (Blender as a module) and LuxCore, for bench-peers; each where pip finds a wheel for this Python.
build/cycles/bin/python:
	$(PYTHON) -m venv build/cycles
	build/cycles/bin/python -m pip install -q bpy || echo "note: bpy does not install here; Cycles is left out" >&2

build/luxcore/bin/python:
	$(PYTHON) -m venv build/luxcore
	build/luxcore/bin/python -m pip install -q pyluxcore numpy || echo "note: pyluxcore does not install here; LuxCore is left out" >&2

build/reference/%_256.npy: | packages-bench .venv/.demo $(MITSUBA_PYTHON)
	$(with_mitsuba) bench/peers_reference.py $*
