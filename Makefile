# SPDX-License-Identifier: BSD-2-Clause
# Abbe: the only entry point. `make` prints the targets; each installs what it needs.

.DEFAULT_GOAL := help
SHELL   := /bin/sh
PYTHON  := .venv/bin/python
PYTEST  := $(PYTHON) -m pytest
JOBS    ?= $(shell nproc)
READY   := .venv/.ready
export PYTHONUTF8 := 1

help: ## Print this help
	@echo "Abbe: an open microscope-stage controller. Targets:"; echo
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-15s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)
	@echo; echo "New here? 'make demo', then docs/quickstart.md."

setup: $(READY) ## Install the pinned tools (every target does this by itself)

$(READY): requirements.txt firmware/libraries.toml host/setup.sh host/sources.py
	@host/setup.sh
	@touch $@

# --- the main job ------------------------------------------------------------------------------------------

demo: $(READY) ## Scan one line on the simulated controller and measure its pins [SPEED= N= ...: docs/quickstart.md]
	@$(PYTHON) -m tb.demo $(if $(SPEED),--speed $(SPEED)) $(if $(N),--n $(N)) $(ARGS)

sim: $(READY) ## The simulated controller with its serial port on a pty
	@$(PYTHON) -m tb.sim.pty $(ARGS)

twin: $(READY) ## The virtual controller at real time, on a pty and a TCP port [SPEED= ARGS=: docs/twin.md]
	@exec $(PYTHON) -m tb.twin $(if $(SPEED),--speed $(SPEED)) $(ARGS)

jitter: $(READY) ## Measure SYNC and pixel clock in a recording: make jitter FILE=capture.vcd [ARGS=...]
	@test -n "$(FILE)" || { echo "usage: make jitter FILE=<recording.vcd|.csv> [ARGS='--n 24 ...']"; exit 2; }
	@$(PYTHON) -m host.jitter "$(FILE)" $(ARGS)

# --- tests --------------------------------------------------------------------------------------------------

test: lint ## All tests of the ordinary suite (no board needed)
	@$(PYTEST) -n $(JOBS) --dist worksteal tb

test-rtl: $(READY) ## Gateware blocks at their pins and over their bus, the quick proofs, the manual's figures
	@$(PYTEST) -n $(JOBS) --dist worksteal tb/rtl tb/formal tb/vectors

test-firmware: $(READY) ## Firmware on the host, under sanitizers
	@$(PYTEST) -n $(JOBS) --dist worksteal tb/firmware tb/board

test-system: $(READY) ## The real firmware on the real SoC, in Verilator
	@$(PYTEST) -n $(JOBS) --dist worksteal tb/soc tb/sim tb/system

test-twin: $(READY) ## The virtual controller: its ports, its model against the gateware, other people's host programs
	@$(PYTEST) -n $(JOBS) --dist worksteal tb/twin tb/clients tb/soak

test-slow: $(READY) ## What the ordinary suite has no time for: every scan at full length, every transcript on the SoC, a million numbers on the target's objects, two equal bitstreams, the product's netlist, every proof
	@FULL_LINES=1 $(PYTEST) --timeout 0 -n $(JOBS) --dist worksteal tb/system/test_scan_walk.py tb/system/test_scan_field.py tb/system/test_trigger_walk.py tb/system/test_servo_lock_walk.py tb/system/test_ttl_report_walk.py tb/system/test_transcripts.py tb/twin/test_scans.py
	@$(MAKE) --no-print-directory test-numbers
	@FULL_BUILD=1 $(PYTEST) --timeout 0 tb/gateware/test_product.py
	@$(MAKE) --no-print-directory test-gates-soc
	@$(PYTHON) -m tb.formal

test-host: $(READY) ## The analyser and the demo's own checks, on recordings with faults in them
	@$(PYTEST) -n $(JOBS) --dist worksteal tb/host

test-transcripts: $(READY) ## What hosts say and must be told [PORT=device|pty|host:port FILES=... ARGS=--help]
	@$(PYTHON) -m tb.transcripts $(if $(PORT),--port $(PORT)) $(ARGS) $(FILES)

test-gates: $(READY) ## Every test of a block on the netlist that goes to the FPGA
	@$(PYTEST) -n $(JOBS) --dist worksteal --gates all -m gates tb/rtl tb/gates

fuzz: $(READY) ## libFuzzer on the command language [RUNS=10000000 ARGS=--help]
	@$(PYTHON) -m tb.fuzz $(if $(RUNS),--runs $(RUNS)) $(ARGS)

powercut: $(READY) ## The power fails at every byte and erase of everything that is written to flash [ARGS="SCENARIO... --pairs 4 --every 1"]
	@$(PYTHON) -m tb.powercut $(ARGS)

test-numbers: $(READY) ## A million numbers on the target's objects and on the host's: the same bytes
	@$(PYTHON) -m tb.firmware.numbers

soak: $(READY) ## A million commands without a pause into the virtual controller, each answered once and in order [COMMANDS= SPEED=20]
	@$(PYTHON) -m tb.soak $(if $(COMMANDS),--commands $(COMMANDS)) $(if $(SPEED),--speed $(SPEED)) $(ARGS)

bench: $(READY) ## How fast and how well the servo moves four lead screws, beside the original; build/bench/motion.json
	@$(PYTHON) -m tb.bench

bench-timing: $(READY) ## Every figure of the timing modules at the pins, beside the original; build/bench/timing.json [ARGS=group...]
	@$(PYTHON) -m tb.bench.timing $(ARGS)

test-gates-soc: $(READY) ## The product's whole netlist, with its firmware, from configuration to its first replies
	@GATES_SOC=1 $(PYTEST) --timeout 0 tb/gates/test_soc.py

formal: $(READY) ## All proofs, with mode, depth and widths
	@$(PYTHON) -m tb.formal $(ARGS)

mutate: $(READY) ## 200 mutants of each timing block: how many do its tests and proofs notice? build/mutate/report.json [ARGS="decoder --mutants 40"]
	@$(PYTHON) -m tb.mutate $(ARGS)

lint: $(READY) ## Generated pages are up to date; the pins of every board keep their rules
	@$(PYTHON) -m soc.generate --check
	@$(PYTHON) -m firmware.manual.commands --check
	@$(PYTHON) -m soc.pins --check

# --- products -----------------------------------------------------------------------------------------------

gen: $(READY) ## Registers (C header, linker memory, docs/registers.md) and docs/commands.md
	@$(PYTHON) -m soc.generate
	@$(PYTHON) -m firmware.manual.commands

pins: $(READY) ## Pins of every board: checked, and docs/boards/*-pins.* drawn from constraints/*.lpf
	@$(PYTHON) -m soc.pins

firmware: $(READY) ## The firmware image for the soft core
	@$(MAKE) --no-print-directory -C firmware

board = @test -n "$(BOARD)" || { echo "usage: make $(firstword $(MAKECMDGOALS)) BOARD=ulx3s-85f"; exit 2; }

gateware: $(READY) gen ## A board's bitstream with its report: make gateware BOARD=ulx3s-85f [SEED=1] [ALLOW_MISS=1]
	$(board)
	@$(PYTHON) -m soc.gateware $(BOARD) $(if $(SEED),--seed $(SEED)) $(if $(ALLOW_MISS),--allow-miss)

gateware-seeds: $(READY) gen ## Timing of a board with five seeds: make gateware-seeds BOARD=ulx3s-85f
	$(board)
	@$(PYTHON) -m soc.gateware_seeds $(BOARD)

loader: $(READY)
	$(board)
	@$(PYTHON) -m soc.programmer $(BOARD) check
	@command -v openFPGALoader >/dev/null || host/setup.sh openfpgaloader

flash: loader gateware ## Write a board's flash, which it loads at power-up: make flash BOARD=ulx3s-85f
	@$(PYTHON) -m soc.programmer $(BOARD) flash

program: loader gateware ## Load a board until power-off: make program BOARD=ulx3s-85f
	@$(PYTHON) -m soc.programmer $(BOARD) program

clean: ## Remove everything built (keeps the tools)
	rm -rf build

distclean: clean ## Remove the installed tools too
	rm -rf .venv

.PHONY: help setup demo sim twin jitter bench bench-timing test test-rtl test-firmware test-system test-twin test-slow test-host test-transcripts test-gates test-numbers fuzz powercut soak formal mutate lint gen pins firmware gateware gateware-seeds loader flash program clean distclean
