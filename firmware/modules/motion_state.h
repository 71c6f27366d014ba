/* SPDX-License-Identifier: BSD-2-Clause */
/** What modules/motion.c, motion_prepared.c and motion_report.c share, and nobody else; the contract is motion.h's. */
#ifndef MODULES_MOTION_STATE_H
#define MODULES_MOTION_STATE_H

#include "modules/motion.h"

/* What the main loop knows of an axis. The rest is in axis.h. */
struct motion {
    const struct motion_owner *owner;
    bool claimed;
    struct motion_move move; /* the last one, for planning it again */
    bool stopping;           /* the last plan is a stop, not `move` */
    unsigned leg;            /* of the way: before the last one vias, move.via_count is the last */
    bool waiting;            /* `move` is planned when the plan before it has begun */
    int32_t end_counts;      /* where the last plan ends */
    uint32_t news_seen;
    uint32_t arrivals_seen;
    uint32_t stops_seen;
    uint32_t lags_seen;
};

extern struct motion motions[AXIS_COUNT];

/** Other legs follow the present one; and let there be none. */
static inline bool motion_is_under_way(const struct motion *m)
{
    return m->leg < m->move.via_count;
}

static inline void motion_forget_legs(struct motion *m)
{
    m->leg = m->move.via_count;
}

/** Tell the owner of a claimed axis that its motion has ended early. */
void motion_tell(unsigned axis, enum motion_end why);

/** A turn of the main loop: take notice of what the interrupt did with an axis. */
void motion_report(unsigned axis);

/** Whether `owner` gets the axis when it asks; and take it, telling the one it is taken from. */
bool motion_may_take(unsigned axis, const struct motion_owner *owner);
void motion_take(unsigned axis, const struct motion_owner *owner);

/** Write a move's plan, for an axis where it will be at `tick`; the generation it holds for. */
uint32_t motion_plan(unsigned axis, const struct motion_move *move, uint64_t tick);

/** Nothing is prepared from here on; what has begun is its owner's. */
void motion_withdraw_prepared(void);

/** Take notice of a prepared motion that has begun, or cannot. */
void motion_notice_prepared(void);

/** A plan of the axis waits for its tick, was late, or has been let go by the trigger. */
bool motion_handed_over(unsigned axis);

void motion_prepared_init(void);

#endif
