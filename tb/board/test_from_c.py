# SPDX-License-Identifier: BSD-2-Clause
"""The model's C interface from C11, as the firmware's host build uses it: no Python, no TOML, strict warnings."""

import subprocess

from tb.board import plant
from tb.board.board import SOURCES, Board
from tb.board.library import FLAGS

PROGRAM = r"""
#include <inttypes.h>
#include <stdio.h>
#include "board.h"

int main(void)
{
    static char text[16384];
    char error[200];
    text[fread(text, 1, sizeof text - 1, stdin)] = '\0';
    struct board *board = board_create(text, error, sizeof error);
    if (!board) {
        puts(error);
        return 1;
    }
    for (int64_t time_ps = 0; time_ps < INT64_C(100000000000); time_ps += INT64_C(200000000)) {
        board_drive(board, time_ps, 0, 0.75);
        board_drive(board, time_ps, 1, -0.25);
        board_advance(board, time_ps + INT64_C(200000000));
    }
    printf("%" PRId64 " %" PRId64 " %d\n", board_count(board, 0), board_count(board, 1), board_pins(board)->enc_a);
    board_destroy(board);
    return 0;
}
"""


def build(directory):
    (directory / "program.c").write_text(PROGRAM)
    here = SOURCES[0].parent
    subprocess.run(["gcc", "-std=c11", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wmissing-prototypes", "-Werror",
                    "-I", here, "-c", "program.c"], cwd=directory, check=True)
    subprocess.run(["g++", *FLAGS, "-fsanitize=undefined,address", "-o", "program", "program.o", *SOURCES],
                   cwd=directory, check=True)
    return directory / "program"


def test_a_c_program_sees_the_stage_that_python_sees(tmp_path):
    program = build(tmp_path)
    done = subprocess.run([program], input=plant.render(plant.load()), capture_output=True, text=True)
    board = Board()
    board.drive(0, 0.75)
    board.drive(1, -0.25)
    board.advance(100 * 10**9)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == f"{board.count(0)} {board.count(1)} {board.pins.enc_a}\n"
    assert board.count(0) > 10_000 > -1000 > board.count(1)
    done = subprocess.run([program], input="x.pitch_mm=6.35\n", capture_output=True, text=True)
    assert done.returncode == 1 and done.stdout.startswith("missing plant parameter")
