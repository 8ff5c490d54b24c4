# make setup | test | commands | demo | lint | clean. Needs python 3.11 or newer and pip; everything else goes into .venv.
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/set-up-from-pyproject-and-constraints

.PHONY: setup test commands demo lint clean firmware-check

setup: $(STAMP)

$(STAMP): pyproject.toml constraints.txt .ci/set_up
	@.ci/set_up $(VENV)
	@touch $@

# The emulated board is ended by its watchdog where both cores are taken, and a viewer's processor time is measured: their
# tests run after the others, alone. What runs every command that the docs show takes minutes: a target of its own.
BOARD := tests/rig tests/viz/test_sessions_of_verbs.py
SHOWN := tests/docs/test_commands.py
test: setup
	$(BIN)/python -m pytest -n 2 --dist loadfile $(BOARD:%=--ignore=%) --ignore=$(SHOWN)
	$(BIN)/python -m pytest $(BOARD)

commands: setup
	$(BIN)/python -m pytest $(SHOWN)

demo: setup
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
