# make demo | test | long | commands | lint | setup | clean. Needs python 3.11 or newer and pip; everything else goes into .venv.
# demo sets up what a user needs; test, commands and lint set up what the tests and the documentation need besides.
VENV := .venv
BIN := $(VENV)/bin
RUNTIME := $(VENV)/set-up-for-use
EVERYTHING := $(VENV)/set-up-for-tests
READ := pyproject.toml constraints.txt .ci/set_up

.PHONY: runtime setup test long commands demo lint clean firmware-check

runtime: $(RUNTIME)

setup: $(EVERYTHING)

$(RUNTIME): $(READ)
	@.ci/set_up $(VENV)
	@touch $@

$(EVERYTHING): $(READ)
	@.ci/set_up $(VENV) dev
	@touch $(RUNTIME) $@

# The emulated board is ended by its watchdog where both cores are taken, and a viewer's processor time is measured: their
# tests run after the others, alone. What runs every command that the docs show takes minutes: a target of its own.
BOARD := tests/rig tests/viz/test_sessions_of_verbs.py
SHOWN := tests/docs/test_commands.py
test: setup
	$(BIN)/python -m pytest -n 2 --dist loadfile -m "not long" $(BOARD:%=--ignore=%) --ignore=$(SHOWN)
	$(BIN)/python -m pytest -m "not long" $(BOARD)

long: setup  # real data, series, searches: with `test` all that a change must pass
	$(BIN)/python -m pytest -n 2 --dist load -m long

hostile: setup  # every hostile trial: damaged inputs, full disks, signals, torn caches; a quarter of an hour
	$(BIN)/python -m tests.hostile.run

commands: setup
	$(BIN)/python -m pytest $(SHOWN)

demo: runtime
	$(BIN)/tentacle demo

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/pyright --pythonpath $(BIN)/python
	$(BIN)/lint-imports

clean:
	rm -rf $(VENV)

firmware-check:  # the board's core for a Cortex-M3, where arm-none-eabi-g++ is installed
	$(MAKE) -C rig/firmware firmware-check
