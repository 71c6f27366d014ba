/* SPDX-License-Identifier: BSD-2-Clause */
/** What a block has under way: events in order of time; at the same edge in order of kind, then first come first. */
#ifndef TWIN_AGENDA_H
#define TWIN_AGENDA_H

#include <cstdint>
#include <vector>

#include "clock.h"

namespace twin {

template <class Kind> class Agenda {
public:
    /** `due`: kept at the time of the next event. */
    explicit Agenda(Time &due) : due_(due) { due_ = NEVER; }

    struct Event {
        Time at;
        Kind kind;
        uint64_t value;
    };

    void add(Time at, Kind kind, uint64_t value = 0)
    {
        auto place = events_.end();
        while (place != events_.begin()) {
            const Event &sooner = *(place - 1);
            if (at < sooner.at || (at == sooner.at && kind < sooner.kind))
                break;
            --place;
        }
        events_.insert(place, {at, kind, value});
        due_ = events_.back().at;
    }

    Time next() const { return events_.empty() ? NEVER : events_.back().at; }

    Event take()
    {
        const Event event = events_.back();
        events_.pop_back();
        due_ = next();
        return event;
    }

private:
    Time &due_;
    std::vector<Event> events_; /* the next one last; seldom more than a handful */
};

} // namespace twin

#endif
