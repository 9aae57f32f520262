# Everything from git, make and Python 3.11 alone: each target sets up its own virtual environment first.
PYTHON ?= python3.11
VENV := .venv
BIN := $(VENV)/bin

# Bytecode is kept between runs: each worker of the tests would rewrite every test file anew.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: demo test slow real check bench proof proof-blind proof-identify fuzz soak mutation docs docs-check licences audit wheel-check effects picture lock clean

demo: $(VENV)/ready-run
	$(BIN)/nxt-twin demo

test: $(VENV)/ready-dev
	$(BIN)/python -m pytest -n auto --dist worksteal --quick

# The tests that take longest, which `make test` leaves out and names at its end.
slow: $(VENV)/ready-dev
	$(BIN)/python -m pytest -n auto --dist worksteal -m slow $(PYTEST_ARGS)

# The tests of real recordings alone, which nobody may pass on (docs/real-data.md): minutes.
REAL_DATA := $(or $(NXT_TWIN_DATA),$(wildcard ../shared/data))
real: $(VENV)/ready-dev
	@test -d "$(REAL_DATA)" || { echo "make real: no folder of real recordings; set NXT_TWIN_DATA (docs/real-data.md)" >&2; exit 1; }
	NXT_TWIN_DATA=$(abspath $(REAL_DATA)) $(BIN)/python -m pytest -n auto --dist worksteal -m real_data $(PYTEST_ARGS)

check: $(VENV)/ready-dev
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python tools/check_house.py
	$(BIN)/python tools/docs_check.py
	$(BIN)/python tools/audit.py

bench: $(VENV)/ready-run
	$(BIN)/python -m benchmarks

# The benchmark of concealed effects with its aims, and the coverage of every identification: minutes each.
proof-blind: $(VENV)/ready-run
	$(BIN)/nxt-twin blind bench build/blind --seed 1 --jobs 2

# A sample over all truth families, every table of docs/proof.md; run again, it goes on where it stopped.
proof: $(VENV)/ready-dev
	$(BIN)/nxt-twin blind proof build/proof

proof-identify: $(VENV)/ready-run
	OMP_NUM_THREADS=1 $(BIN)/python -m benchmarks identify

# How hard it is to break (docs/reliability.md): hostile inputs for every parser; kills, cuts, full disks, a long session.
fuzz: $(VENV)/ready-run
	$(BIN)/python -m benchmarks.reliability fuzz

soak: $(VENV)/ready-run
	$(BIN)/python -m benchmarks.reliability soak
# One change at a time in the files that matter most, in a copy: does a test notice? Bounded; SAMPLE mutations a file.
SAMPLE ?= 6
mutation: $(VENV)/ready-dev
	$(BIN)/python tools/mutation.py --sample $(SAMPLE)

# The documentation as a site in build/site; a dead link or anchor fails it, and so does anything asked of another machine.
docs: $(VENV)/ready-dev
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet
	$(BIN)/python tools/site_assets.py build/site

# A dead link; or a verb, an option, a key, an effect or an exit status that no page tells. `make check` asks it too.
docs-check: $(VENV)/ready-dev
	$(BIN)/python tools/docs_check.py

licences: $(VENV)/ready-dev
	$(BIN)/python tools/licences_page.py

# Both need a network, and say so where there is none. `make check` asks the first too.
audit: $(VENV)/ready-dev
	$(BIN)/python tools/audit.py

wheel-check: $(VENV)/ready-dev
	$(BIN)/python tools/wheel_check.py

effects: $(VENV)/ready-run
	$(BIN)/python tools/effects_page.py

picture: $(VENV)/ready-dev
	$(BIN)/python tools/readme_picture.py
	$(BIN)/python tools/dashboard_picture.py
	$(BIN)/python tools/dashboard_world_picture.py
	$(BIN)/python tools/world_picture.py

$(VENV)/bin/python:
	$(PYTHON) -m venv $(VENV)

$(VENV)/ready-run: requirements/run.lock pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements/run.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	touch $@

$(VENV)/ready-dev: requirements/dev.lock $(VENV)/ready-run
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements/dev.lock
	touch $@

# The only target that needs uv: locks carry versions and hashes, and no addresses.
lock:
	uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-header --no-annotate \
		--extra view pyproject.toml requirements/build.in --output-file requirements/run.lock
	uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-header --no-annotate \
		--all-extras --group dev --constraint requirements/run.lock pyproject.toml requirements/build.in --output-file requirements/dev.lock

clean:
	rm -rf $(VENV) build dist
