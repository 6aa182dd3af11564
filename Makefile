# Set-up: everything lands in .venv at the root of this checkout.
PYTHON ?= python3
BIN := .venv/bin
STAMP := .venv/.installed

BENCH_BIN := .bench-venv/bin
BENCH_STAMP := .bench-venv/.installed

.PHONY: bench demo test check lint unit lock warmup clean

demo: $(STAMP)  ## the main job: the rig's case file to a report
	$(BIN)/thermogear example rig > .venv/rig.toml
	$(BIN)/thermogear run .venv/rig.toml -o .demo

test: $(STAMP) lint  ## every check, slow layer included
	$(BIN)/python -m pytest -q -n auto --dist loadfile

check: $(STAMP) lint unit  ## the fast checks

lint: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

unit: $(STAMP)
	$(BIN)/python -m pytest -q -n auto --dist loadfile -m "not slow"

$(STAMP): pyproject.toml requirements/boot.txt requirements/dev.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "thermogear needs Python 3.11 or newer; got $$($(PYTHON) --version); set PYTHON=python3.11"; exit 2; }
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements/boot.txt
	VIRTUAL_ENV=$(CURDIR)/.venv $(BIN)/uv pip install --quiet --require-hashes -r requirements/dev.txt
	VIRTUAL_ENV=$(CURDIR)/.venv $(BIN)/uv pip install --quiet --no-deps --no-build-isolation -e .
	@touch $@

bench: $(BENCH_STAMP)  ## peers side by side, own environment; BENCH=--quick for a short one
	PYTHONPATH=src $(BENCH_BIN)/python bench/run.py $(BENCH)

$(BENCH_STAMP): $(STAMP) requirements/bench.txt requirements/bench-fortran.txt
	test -x $(BENCH_BIN)/python || $(BIN)/python -m venv .bench-venv
	VIRTUAL_ENV=$(CURDIR)/.bench-venv $(BIN)/uv pip install --quiet --require-hashes -r requirements/bench.txt
	@VIRTUAL_ENV=$(CURDIR)/.bench-venv $(BIN)/uv pip install --quiet --no-deps --require-hashes \
	  -r requirements/bench-fortran.txt 2> .bench-venv/fortran.log || \
	  echo "numbalsoda could not be installed (.bench-venv/fortran.log); the table says so"
	@touch $@

lock: $(STAMP)  ## refresh the hashed locks (no addresses are written)
	echo "uv" | $(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes \
	  --no-header --no-emit-index-url --no-emit-find-links - -o requirements/boot.txt
	$(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes \
	  --no-header --no-emit-index-url --no-emit-find-links --all-extras pyproject.toml -o requirements/dev.txt
	$(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes \
	  --no-header --no-emit-index-url --no-emit-find-links bench/requirements.in -o requirements/bench.txt
	$(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-deps \
	  --no-header --no-emit-index-url --no-emit-find-links bench/fortran.in -o requirements/bench-fortran.txt

clean:
	rm -rf .venv .bench-venv .demo
