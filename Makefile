# Two commands for a newcomer: `make demo` and `make test`. Everything installs into .venv.
PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt

.PHONY: demo test lint unit coverage benchmark mutants fuzz leaderboard clean help

help:  ## list the targets
	@grep -E '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed 's/:.*## /\t/'

# On Linux PyPI's own torch brings gigabytes of CUDA; where its CPU index answers, that is taken.
TORCH_INDEX := https://download.pytorch.org/whl/cpu
TORCH_ANSWERS = $(BIN)/python -c "import sys, urllib.request as u; sys.platform == 'linux' and u.urlopen('$(TORCH_INDEX)/torch/', timeout=5)" 2>/dev/null

$(VENV)/installed: pyproject.toml constraints.txt
	@echo "Installing into $(VENV) (a few minutes the first time) ..."
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	@if $(TORCH_ANSWERS); then $(PIP) --no-deps --index-url $(TORCH_INDEX) torch==2.13.0 2>/dev/null || true; fi
	@$(PIP) -e .
	@touch $@

$(VENV)/installed-dev: $(VENV)/installed
	@$(PIP) -e ".[dev]"
	@touch $@

demo: $(VENV)/installed  ## install, then benchmark REMnet as int8 on the simulated default recordings
	@$(BIN)/bench run --model remnet --backend int8

test: lint unit  ## everything CI checks

lint: $(VENV)/installed-dev  ## ruff, mypy strict, import contracts
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

unit: $(VENV)/installed-dev  ## the test suite on two cores
	$(BIN)/python -m pytest -n 2

coverage: $(VENV)/installed-dev  ## the test suite with its coverage: a third slower
	$(BIN)/python -m pytest -n 2 --cov --cov-report=term:skip-covered

benchmark: $(VENV)/installed-dev  ## speed, as ratios within one run; some 15 minutes on two quiet cores
	KILLS=16 $(BIN)/python -m pytest -p no:xdist -q -s tests/benchmarks --override-ini addopts="--strict-markers"

mutants: $(VENV)/installed-dev  ## plant faults one by one; at least 90 % must fail a test
	OMP_NUM_THREADS=1 $(BIN)/python -m tests.mutation --out build/mutants.json

fuzz: $(VENV)/installed-dev  ## hostile input for every command, 600 cases
	OMP_NUM_THREADS=1 $(BIN)/python -m tests.fuzz --out build/fuzz.json

leaderboard: $(VENV)/installed  ## the full default run behind LEADERBOARD.md
	$(BIN)/bench run --model all --backend all
	$(BIN)/bench leaderboard --out LEADERBOARD.md

clean:  ## remove the environment and caches
	rm -rf $(VENV) .mypy_cache .ruff_cache .import_linter_cache build *.egg-info
