/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The scan line: compare, divider, pulse, router, and their registers: rtl/line.py and what it is made of.
 *
 * A command travels to `fast` with its settings, acts there, and is confirmed by the report, which fetches the state
 * of the line again and again. A step is judged at one edge, when its verdict is due; SYNC, pixel and direct output
 * then take the rest of LINE_LATENCY to the pins.
 */
#ifndef TWIN_LINE_H
#define TWIN_LINE_H

#include "agenda.h"
#include "block.h"
#include "crossing.h"
#include "quadrature.h"
#include "trigger.h"

namespace twin {

class Line final : public Block, public StepListener {
public:
    /** `trigger` is told of OUT0. */
    Line(Outputs &outputs, Quadrature (&encoders)[AXES], Trigger &trigger);

    void step(unsigned axis, bool up, int32_t count, Time edge) override;
    void channel_a(unsigned axis, Time edge) override;

    /** The modulation of the lamp, one of the router's sources. */
    void set_led(bool level, Time edge);

    uint32_t read(uint32_t address, Time edge) override;
    void write(uint32_t address, uint32_t value, Time edge) override;
    void run(Time edge) override;

private:
    /* At one edge in this order: what copies comes before what changes. */
    enum class Kind {
        CAPTURE,     /* `fast` latches the state for the report */
        REPORT,      /* which reaches the registers */
        SEND,        /* a command leaves the registers */
        SEND_LIVE,   /* so do routes, width and axis of the direct output */
        SHOW,        /* at the pins: a source or a route changed ROUTER_LATENCY ago */
        STEP,        /* the verdict on a step */
        PIXEL,       /* what follows from it a clock later */
        STARTED,
        SYNC_RISES,
        COMMAND,     /* a command arrives */
        END,         /* a command ends the line under way */
        PRIMED,      /* and begins the next: results to 0 */
        JUDGE,       /* late or armed */
        JUDGED,
        FALL,        /* end of a pulse */
        LIVE,
        DIRECT,      /* channel A of the direct output is taken */
        DIRECT_OUT,
    };

    struct Route {
        uint32_t source;
        bool invert;
    };
    enum { PIN_OUT0, PIN_SYNC, PIN_ENCODER, PINS };

    /** Registers that a command takes along. */
    struct Settings {
        unsigned compare_axis = 0, divider_axis = 0;
        bool reverse = false, emit = false;
        int32_t reference = 0;
        uint32_t whole = 0, fraction = 0, phase = 0, pixels = 0;
    };

    struct Command {
        bool arm = false, ticket = false;
        Settings settings;
    };

    struct Live {
        uint32_t router[PINS]; /* registers of the router */
        uint32_t width;
        unsigned axis;
        bool operator==(const Live &other) const;
    };

    /** What the report shows. */
    struct State {
        bool armed = false, active = false, late = false, ticket = false;
        unsigned started = 0, finished = 0, went_late = 0;
        uint32_t produced = 0, end_position = 0, merged = 0;
    };

    bool refuses() const;
    void command(uint32_t control, Time edge);
    void consider_sending(Time edge);
    Live live_registers() const;
    void send_live(Time edge);
    void show_interrupt(Time edge);
    void report(Time edge);

    void touch(Time edge);
    void end(Time edge);
    void judge(Time edge);
    void verdict(uint64_t packed, Time edge);
    void progress(bool forward, int32_t count, Time edge);
    void pixel(uint64_t packed, Time edge);
    void trigger(Time edge);
    void set_sync(bool level, Time edge);
    void set_pulse(bool level, Time edge);
    void show_pins(Time edge);

    Outputs &outputs_;
    Quadrature (&encoders_)[AXES];
    Trigger &trigger_;
    Agenda<Kind> agenda_{due};

    /* Registers. */
    Settings registers_;
    Live live_;
    uint32_t interval_min_ = 0;
    EventBits events_;
    bool refused_ = false;

    /* The way of a command: one waits, one is under way until its ticket is in the report. */
    bool waiting_ = false, arming_ = false, ticket_ = false;
    ToFast crossing_;
    Time may_send_ = 0; /* the first edge that sees all of this as it is now */
    Command sent_, command_;
    Past<Live> live_in_force_;
    Live live_sent_;

    /* The line, in `fast`. */
    Time ends_ = -1;           /* the edge at which the last command ended a line */
    bool watching_ = false;        /* steps matter */
    Settings line_;
    int32_t target_ = 0, judged_count_ = 0;
    Past<bool> armed_{false}, active_{false}, emit_{false};
    uint64_t behind_ = 0;      /* edges behind the front */
    uint64_t edges_left_ = 0;  /* to the next pixel */
    uint32_t fraction_ = 0;    /* of the place of the last pixel */
    uint32_t pixels_left_ = 0;
    Time triggered_ = -2;
    uint32_t width_ = 1;       /* of the last pulse */
    Time falls_ = -1;          /* the edge at which it falls */
    bool direct_taken_ = false;
    Past<bool> sync_{false}, pulse_{false}, direct_{false}, led_{false};

    /* The report: the line now, as captured last, and as the registers show it. */
    State state_, captured_, report_;
    Time capture_ = -1;
};

} // namespace twin

#endif
