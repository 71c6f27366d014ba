/* SPDX-License-Identifier: BSD-2-Clause */
#include "parameters.h"

#include <cstdlib>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>

namespace plant {

namespace {

const char *const AXIS_NAMES[BOARD_AXES] = {"x", "y", "z", "f"};

/** Where each name's value goes. */
std::map<std::string, double *> places(Parameters &parameters)
{
    std::map<std::string, double *> place{{"plant_step_ns", &parameters.plant_step_ns},
                                          {"contact_bounce_ms", &parameters.contact_bounce_ms},
                                          {"knob_bounce_us", &parameters.knob_bounce_us}};
    for (int n = 0; n < BOARD_AXES; n++) {
        AxisParameters &axis = parameters.axis[n];
        const std::string prefix = std::string(AXIS_NAMES[n]) + ".";
        const std::pair<const char *, double *> own[] = {
            {"pitch_mm", &axis.pitch_mm},
            {"counts_per_mm", &axis.counts_per_mm},
            {"maximum_speed_mm_per_s", &axis.maximum_speed_mm_per_s},
            {"free_speed_ratio", &axis.free_speed_ratio},
            {"speed_scale", &axis.speed_scale},
            {"mechanical_time_constant_ms", &axis.mechanical_time_constant_ms},
            {"electrical_time_constant_ms", &axis.electrical_time_constant_ms},
            {"breakaway_friction", &axis.breakaway_friction},
            {"running_friction", &axis.running_friction},
            {"limit_lower_mm", &axis.limit_lower_mm},
            {"limit_upper_mm", &axis.limit_upper_mm},
            {"end_stop_mm", &axis.end_stop_mm},
            {"start_counts", &axis.start_counts},
            {"index_counts", &axis.index_counts},
        };
        for (const auto &[name, value] : own)
            place.emplace(prefix + name, value);
    }
    return place;
}

} // namespace

Parameters parse(const char *text)
{
    Parameters parameters{};
    std::map<std::string, double *> missing = places(parameters);
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        if (line.empty())
            continue;
        const std::string::size_type equals = line.find('=');
        if (equals == std::string::npos)
            throw std::invalid_argument("expected name=value, not \"" + line + "\"");
        const auto place = missing.find(line.substr(0, equals));
        if (place == missing.end())
            throw std::invalid_argument("unknown or repeated plant parameter in \"" + line + "\"");
        const char *const number = line.c_str() + equals + 1;
        char *end = nullptr;
        *place->second = std::strtod(number, &end);
        if (end == number || *end != '\0')
            throw std::invalid_argument("expected a number in \"" + line + "\"");
        missing.erase(place);
    }
    if (!missing.empty())
        throw std::invalid_argument("missing plant parameter " + missing.begin()->first);
    return parameters;
}

} // namespace plant
