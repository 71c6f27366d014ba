/* SPDX-License-Identifier: BSD-2-Clause */
#include "servo/nudge.h"

void nudge_reset(const struct nudge_config *cfg, struct nudge_state *st)
{
    st->active = false;
    st->strength_steps = cfg->first_steps;
    st->side = 0;
    st->wait_turns = 0;
}

/* The strength for a new pulse, from what the last one did: more while it takes the axis less than
 * half the way that is left, less after it went past the target. */
static int32_t strength(const struct nudge_config *cfg, const struct nudge_state *st, int32_t side,
                        int32_t error_counts, int32_t position_counts)
{
    int32_t steps = st->strength_steps;
    int64_t moved = ((int64_t)position_counts - st->from_counts) * side;

    if (st->side == 0)
        return steps;
    if (side != st->side)
        steps -= steps / 4;
    else if (2 * moved < (int64_t)error_counts * side)
        steps += steps / 8 + 1;
    return steps > cfg->limit_steps ? cfg->limit_steps : steps;
}

int32_t nudge_turn(const struct nudge_config *cfg, struct nudge_state *st, int32_t error_counts,
                   int32_t position_counts, uint32_t still_turns)
{
    int32_t side = error_counts > 0 ? 1 : -1;

    if (st->wait_turns > 0) {
        st->wait_turns--;
        return 0;
    }
    if (still_turns < cfg->rest_turns)
        return 0;
    st->strength_steps = strength(cfg, st, side, error_counts, position_counts);
    st->side = side;
    st->from_counts = position_counts;
    st->wait_turns = cfg->rest_turns;
    return side * st->strength_steps;
}
