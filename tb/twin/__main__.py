# SPDX-License-Identifier: BSD-2-Clause
"""``make twin``: the virtual controller at real time, for developing host software without hardware.

The first lines on standard output are ``serial port: PATH`` and ``tcp port: N`` (of this machine only), both the
controller's main serial line, then ``report port: PATH`` and ``report tcp port: N``, which only send.  SIGTERM or Ctrl-C
ends it.
"""

import argparse
import os
import sys

from tb.board import plant
from tb.sim.pty import Parser, override, positive
from tb.twin import twin


def tcp_port(text):
    number = int(text)
    if not 0 <= number < 65536:
        raise argparse.ArgumentTypeError(f"expected 0 to 65535, not {text}")
    return number


def parse(arguments=None):
    parser = Parser(prog="make twin", description=__doc__.split("\n\n")[0])
    parser.add_argument("more_plant", nargs="*", type=override, metavar="[axis.]name=value", help="as --plant")
    parser.add_argument("--plant", action="append", default=[], type=override, metavar="[AXIS.]NAME=VALUE",
                        help="change a parameter of the simulated stage, such as x.running_friction=0.2 "
                             "(tb/board/plant.toml); may be repeated")
    parser.add_argument("--speed", type=positive, default=1, metavar="N",
                        help="times real time, as far as the machine can (default: %(default)g)")
    parser.add_argument("--tcp-port", type=tcp_port, default=0, metavar="N", help="default: any that is free")
    parser.add_argument("--settings", metavar="FILE",
                        help="where SAVESET keeps settings; without it they are lost at the end")
    parser.add_argument("--flash", metavar="FILE",
                        help="a board with a flash, whose contents are this file, made if it is missing; settings are kept in it")
    options = parser.parse_args(arguments)
    options.plant += options.more_plant
    return options


def main(arguments=None):
    options = parse(arguments)
    try:
        program = twin.build()
    except RuntimeError as error:
        print(f"the virtual controller could not be built: {error}", file=sys.stderr)
        return 2
    command = twin.command(program, parameters=plant.render(plant.load(options.plant)), speed=options.speed,
                           tcp_port=options.tcp_port, settings=options.settings, flash=options.flash)
    os.execv(command[0], command)       # the same process, so that a signal to it reaches the controller


if __name__ == "__main__":
    sys.exit(main())
