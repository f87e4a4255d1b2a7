# Everything makes its own environment: a Rust toolchain, Python 3.11+ and make are enough.
PYTHON ?= python3
VENV := .venv
ROS := .venv-ros
BIN := $(VENV)/bin
CORES := $(shell $(PYTHON) -c "import os; print(os.cpu_count())")
SOURCES := $(shell find rust python -name '*.rs' -o -name '*.py' -o -name '*.csv' -o -path '*.data/*' -type f) Cargo.toml Cargo.lock pyproject.toml \
	$(wildcard rust/*/Cargo.toml)

PAGES = $(wildcard docs/*.md docs/*/*.md)

SOAK ?= 50
SOAKED = $(patsubst %,tests/%,core/oracles/test_batch.py core/oracles/test_rollout.py core/oracles/test_fast.py \
	core/boundary/test_memory.py core/door/test_storm.py core/control/test_profiles.py core/control/test_profile_limits.py \
	core/control/test_transitions.py core/control/test_controller.py core/control/test_controller_options.py \
	cli/test_exit.py kinematics/odometry log_odometry/test_dead_reckon.py calibration core/ground/test_bounds.py \
	core/ground/test_touching.py core/ground/test_mujoco.py core/ground/test_growth.py)

HOST = $(shell rustc -vV | sed -n 's/^host: //p')
SANITIZED ?= target/sanitize
WATCHED = LD_PRELOAD=$$($(CC) -print-file-name=libasan.so) ASAN_OPTIONS=detect_leaks=0 PYTHONMALLOC=malloc \
	PYTHONPATH=$(SANITIZED)/python
# Four angles in an array that claims them and holds two.
PAST_THE_END = import numpy as np, six_wheel as sw; angles = np.lib.stride_tricks.as_strided(np.zeros(2), (4,), (8,)); \
	sw.Rover.preset('perseverance').forward(angles, np.zeros(6))

# Coverage-guided fuzzing, so many seconds for every target.
FUZZ ?= 60
FUZZED = estimate odometry controller
READERS = yaml commands log bag urdf
ROWS ?= 1e9
COVERAGE = -Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 -Cllvm-args=-sanitizer-coverage-trace-compares \
	-Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table -Ccodegen-units=1
NUMPYS ?= numpy==1.26.* numpy
BOUNDARY = tests/core/boundary tests/core/door tests/core/laws/test_geometry.py tests/core/laws/test_fit.py
PYTHONS ?= python3.11 python3.12 python3.13 python3.14

.PHONY: demo quick test test-rust test-python test-ros test-versions fuzz compare soak holding sanitize bench bench-suites \
	instructions profiling docs lint format wheel clean

demo: $(VENV)/installed ## drive Mars rovers along a recorded path and over rocks; writes six_wheel_demo/
	$(BIN)/six-wheel demo

# The first time it needs what the package needs, so that it installs it; later builds are its own.
quick: $(VENV)/tools $(if $(wildcard $(VENV)/installed),,$(VENV)/installed) ## checks and tests of what changed, in a minute; CRATE= and ROOM= choose
	$(BIN)/python -m tests.quick

test: test-rust test-python test-ros ## every test

test-rust:
	cargo test --workspace --locked

test-python: $(VENV)/installed ## all tests of the package, or those that PYTEST= says
	$(BIN)/python -m pytest -n $(CORES) --dist loadfile --no-loadscope-reorder $(PYTEST)

# Where rclpy cannot be had the reason is in $(ROS)/without, and there is nothing to test.
test-ros: $(ROS)/installed ## the nodes as processes, with rclpy from the package index in an environment of its own
	@if test -s $(ROS)/without; then echo "test-ros: skipped, no rclpy here: $$(tail -n 1 $(ROS)/without)"; else \
		$(ROS)/bin/python -m pytest tests/control_loop/ros2 -o addopts=-ra -p no:cacheprovider; fi

fuzz: $(VENV)/installed ## coverage-guided fuzzing of core, boundary and readers, FUZZ seconds each; finds go to target/fuzz
	for target in $(FUZZED); do mkdir -p target/fuzz/$$target \
		&& RUSTFLAGS="$(COVERAGE) --cfg fuzzing" cargo build --release --quiet --manifest-path rust/fuzz/Cargo.toml \
			--target $(HOST) --target-dir target/fuzz/build --bin $$target \
		&& target/fuzz/build/$(HOST)/release/$$target -max_total_time=$(FUZZ) -max_len=4096 -print_final_stats=1 \
			-artifact_prefix=target/fuzz/$$target- target/fuzz/$$target || exit 1; done
	$(BIN)/python -m pip install --quiet --only-binary :all: atheris || echo "no atheris for this Python: its part is skipped"
	$(BIN)/python -c "import atheris" 2>/dev/null || exit 0; mkdir -p target/fuzz/boundary \
		&& $(BIN)/python tests/core/door/fuzzed.py -max_total_time=$(FUZZ) -artifact_prefix=target/fuzz/boundary- \
			target/fuzz/boundary \
		&& for target in $(READERS); do mkdir -p target/fuzz/$$target \
			&& $(BIN)/python -m tests.fuzz.fuzzed $$target target/fuzz/$$target -max_total_time=$(FUZZ) -timeout=20 \
				-artifact_prefix=target/fuzz/$$target- || exit 1; done

compare: $(VENV)/installed ## every level against the scalar one, ROWS rows of calls; the worst case of each
	$(BIN)/python -m tests.core.oracles.compare --rows $(ROWS)

# All that pyenv has, if it is there.
test-versions: export PYENV_VERSION = $(shell pyenv versions --bare 2>/dev/null | paste -sd:)
test-versions: $(VENV)/installed ## the boundary with every Python there is, with the oldest NumPy and the newest; PYTHONS= and NUMPYS= choose
	for python in $(PYTHONS); do $$python --version > /dev/null 2>&1 || { echo "$$python: not on this machine, skipped"; continue; }; \
		for numpy in $(foreach numpy,$(NUMPYS),"$(numpy)"); do home=target/versions/$$python-$${numpy%%=*}-$${#numpy}; \
		test -x $$home/bin/python || $$python -m venv $$home; \
		$$home/bin/python -m pip install --quiet --only-binary :all: "$$numpy" pytest pytest-xdist hypothesis \
			|| { echo "$$python: no wheel of $$numpy, skipped"; continue; }; \
		$$home/bin/python -m pip install --quiet --no-deps --force-reinstall $(VENV)/wheels/*.whl \
			&& $$home/bin/python -c "import sys, numpy; print(sys.version.split()[0], 'NumPy', numpy.__version__)" \
			&& $$home/bin/python -m pytest -q -n $(CORES) --dist loadfile -p no:cacheprovider -o addopts= $(BOUNDARY) \
			|| exit 1; done; done

soak: $(VENV)/installed ## the tests that can go on for long, SOAK times as many cases; prints the worst ones
	SOAK=$(SOAK) $(BIN)/python -m pytest $(SOAKED) -s -q
	SOAK=$$((2 * $(SOAK))) cargo test --release --locked --package six-wheel-control --test controller

# Some hours of one core; HOLDING="1e6 --seconds 600" for a look.
HOLDING ?= 1e8
holding: $(VENV)/installed ## settled poses against their bounds, so many; ends with the first that is outside
	$(BIN)/python -m tests.core.ground.holding $(HOLDING)

sanitize: $(VENV)/installed ## AddressSanitizer over the quick way of single calls (Linux, with gcc's runtime of it)
	RUSTC_BOOTSTRAP=1 RUSTFLAGS=-Zsanitizer=address cargo build --package six-wheel-py --locked \
		--target $(HOST) --target-dir $(SANITIZED)
	rm -rf $(SANITIZED)/python && mkdir -p $(SANITIZED)/python && cp -r python/six_wheel $(SANITIZED)/python
	cp $(SANITIZED)/$(HOST)/debug/lib_core.so $(SANITIZED)/python/six_wheel/_core.abi3.so
	$(WATCHED) $(BIN)/python -c "$(PAST_THE_END)" 2>&1 | grep heap-buffer-overflow # it does watch
	$(WATCHED) $(BIN)/python -m pytest tests/core/door/test_overlap.py -q -p no:cacheprovider
	$(WATCHED) $(BIN)/python -m pytest tests/core/oracles/test_fast.py tests/core/oracles/test_fast_misuse.py \
		tests/core/boundary/test_memory.py -q -p no:cacheprovider
	$(WATCHED) $(BIN)/python -m pytest tests/core/oracles/test_batch_forms.py -k "any_form or any_order" -q -p no:cacheprovider
	$(WATCHED) $(BIN)/python -m pytest tests/core/boundary/test_kept_memory.py -k result -q -p no:cacheprovider

bench: $(VENV)/peers ## the core and its peers in one run: tables with ratios and goals; BENCH="--markdown" and others
	$(BIN)/python benches/run.py $(BENCH)

bench-suites: $(VENV)/peers ## the same jobs under pytest-benchmark
	$(BIN)/python -m pytest benches --benchmark-enable --benchmark-only -q

instructions: ## callgrind's count of a dozen calls beside benches/instructions.csv: 3 % more fails; COUNT=--write makes it anew
	$(PYTHON) benches/instructions.py $(COUNT)

# Sphinx's trees lie beside the site, or they would double it; -j auto is safe with autosummary.
docs: $(VENV)/docs ## the site, docs/_build/html/index.html: no network, warnings are errors
	rm -rf docs/_build/html
	$(BIN)/python -m sphinx -q -W --keep-going -j auto -b html -d docs/_build/trees docs docs/_build/html
	$(BIN)/python -m pytest -q -p no:cacheprovider tests/house/test_site.py

profiling: $(VENV)/installed ## the installed module with names and lines for perf and valgrind; the next build takes them away
	cargo build --profile profiling --locked --package six-wheel-py
	cp target/profiling/lib_core.so $$($(BIN)/python -c "import six_wheel._core as core; print(core.__file__)")

# Clippy is last: beside `make test-rust` it waits for cargo's lock.
lint: $(VENV)/installed ## what has to be clean before a change lands
	cargo fmt --all --check
	$(BIN)/python -m tests.house.structure
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/ruff format --check --line-length 80 $(PAGES)
	PYTHONPATH=python $(BIN)/lint-imports
	$(BIN)/mypy
	$(BIN)/python -m mypy.stubtest six_wheel._core
	cargo clippy --workspace --all-targets --locked -- -D warnings

format:
	cargo fmt --all
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .
	$(BIN)/ruff format --line-length 80 $(PAGES)

wheel: $(VENV)/tools ## dist/*.whl
	$(BIN)/maturin build --release --locked --out dist

$(VENV)/tools: pyproject.toml
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade "pip>=25.1" "maturin>=1.9,<2"
	$(BIN)/python -m pip install --quiet --group test --group lint
	touch $@

# Built and installed as a user would get it: the wheel, not an editable tree.
$(VENV)/installed: $(VENV)/tools $(SOURCES)
	rm -rf $(VENV)/wheels
	$(BIN)/maturin build --release --locked --out $(VENV)/wheels
	wheel=$$(ls $(VENV)/wheels/*.whl) && $(BIN)/python -m pip install --quiet --force-reinstall --no-deps "$$wheel" \
		&& $(BIN)/python -m pip install --quiet "$$wheel[cli]"
	touch $@

$(VENV)/docs: $(VENV)/installed pyproject.toml
	$(BIN)/python -m pip install --quiet --group docs
	touch $@

$(ROS)/installed: $(VENV)/installed
	test -x $(ROS)/bin/python || $(PYTHON) -m venv $(ROS)
	wheel=$$(ls $(VENV)/wheels/*.whl) && $(ROS)/bin/python -m pip install --quiet --timeout 30 --retries 2 \
		--only-binary ros-rclpy,ros-rcl,cyclonedds "$$wheel[cli,ros]" cyclonedds hypothesis pytest \
		2>$(ROS)/without && : >$(ROS)/without && $(ROS)/bin/python -m pip install --quiet --force-reinstall --no-deps "$$wheel" \
		|| test -s $(ROS)/without
	touch $@

# Without a wheel of a peer for this machine the others still run: what is missing is left out with a word.
$(VENV)/peers: $(VENV)/installed
	wheel=$$(ls $(VENV)/wheels/*.whl) && $(BIN)/python -m pip install --quiet --only-binary :all: "$$wheel[bench]" \
		|| for peer in numba robotpy-wpimath; do $(BIN)/python -m pip install --quiet --only-binary :all: $$peer; done || true
	touch $@

clean:
	rm -rf $(VENV) $(ROS) target dist docs/_build docs/reference/api six_wheel_demo
