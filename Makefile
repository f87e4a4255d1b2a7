# Everything makes its own environment: a Rust toolchain, Python 3.11+ and make are enough.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
SOURCES := $(shell find rust python -name '*.rs' -o -name '*.py' -o -name '*.csv') Cargo.toml Cargo.lock pyproject.toml \
	rust/core/Cargo.toml rust/bindings/Cargo.toml

SOAK ?= 50

.PHONY: demo test test-rust test-python soak bench lint format wheel clean

demo: $(VENV)/installed ## drive two Mars rovers along a recorded path; writes six_wheel_demo/
	$(BIN)/six-wheel demo

test: test-rust test-python ## every test

test-rust:
	cargo test --workspace --locked

test-python: $(VENV)/installed
	$(BIN)/python -m pytest

soak: $(VENV)/installed ## kernels against the plain core over SOAK times as many rows, 2 SOAK million steps of the controller
	SOAK=$(SOAK) $(BIN)/python -m pytest tests/test_batch.py -s -q
	SOAK=$(SOAK) $(BIN)/python -m pytest tests/test_controller.py -q -k drill
	SOAK=$$((2 * $(SOAK))) cargo test --release --locked --package six-wheel-core --test controller

bench: $(VENV)/installed ## pytest-benchmark against the reference, criterion for the core
	$(BIN)/python -m pytest benches --benchmark-enable --benchmark-only -q
	cargo bench --package six-wheel-core --locked

lint: $(VENV)/installed ## what has to be clean before a change lands
	cargo fmt --all --check
	cargo clippy --workspace --all-targets --locked -- -D warnings
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/python -m mypy.stubtest six_wheel._core

format:
	cargo fmt --all
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

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

clean:
	rm -rf $(VENV) target dist six_wheel_demo
