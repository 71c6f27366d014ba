/* SPDX-License-Identifier: BSD-2-Clause */
/** The board's parameters, from the "name=value" lines of tb/board/plant.py. */
#ifndef BOARD_PARAMETERS_H
#define BOARD_PARAMETERS_H

#include "axis.h"
#include "board.h"

namespace plant {

struct Parameters {
    double plant_step_ns;
    double contact_bounce_ms, knob_bounce_us;
    AxisParameters axis[BOARD_AXES];
};

/** @throws std::invalid_argument for a line that is no "name=value", an unknown name, or one that is missing. */
Parameters parse(const char *text);

} // namespace plant

#endif
