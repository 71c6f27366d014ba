/* SPDX-License-Identifier: BSD-2-Clause */
#include "core/events.h"

#include <stdatomic.h>
#include <stddef.h>
#include <string.h>

#include "core/fault.h"
#include "core/module.h"

typedef void (*hook)(const struct event *event);

struct hooks {
    hook main[EVENT_HOOKS_MAX];
    hook interrupt[EVENT_HOOKS_MAX];
    uint8_t main_count, interrupt_count;
};

/* Events on their way to the main hooks; one producer each, main loop or interrupts. */
struct queue {
    struct event events[EVENT_QUEUE];
    _Atomic uint32_t head, tail;
};

static struct hooks hooks[EVENT_COUNT];
static struct queue from_main, from_interrupt;
static uint64_t (*clock_fast)(void);
static volatile bool lost; /* an event found its queue full; logged by events_poll */

bool events_heard(enum event_name name)
{
    return hooks[name].interrupt_count + hooks[name].main_count > 0;
}

static bool add(hook *list, uint8_t *count, hook run)
{
    if (*count == EVENT_HOOKS_MAX)
        return false;
    list[(*count)++] = run;
    return true;
}

bool events_init(const struct module *const *modules)
{
    bool all = true;

    memset(hooks, 0, sizeof hooks);
    from_main.tail = from_main.head;
    from_interrupt.tail = from_interrupt.head;
    for (; *modules != NULL; modules++) {
        const struct subscription *row = (*modules)->subscriptions;

        for (; row != NULL && row->event != EVENT_NONE; row++) {
            struct hooks *to = &hooks[row->event];

            all &= row->context == EVENT_IN_MAIN
                       ? add(to->main, &to->main_count, row->run)
                       : add(to->interrupt, &to->interrupt_count, row->run);
        }
    }
    return all;
}

void events_set_clock(uint64_t (*now_fast)(void))
{
    clock_fast = now_fast;
}

uint64_t events_now(void)
{
    return clock_fast != NULL ? clock_fast() : 0;
}

static bool queue_put(struct queue *queue, const struct event *event)
{
    uint32_t head = atomic_load_explicit(&queue->head, memory_order_relaxed);

    if (head - atomic_load_explicit(&queue->tail, memory_order_relaxed) == EVENT_QUEUE)
        return false;
    queue->events[head % EVENT_QUEUE] = *event;
    atomic_signal_fence(memory_order_release);
    atomic_store_explicit(&queue->head, head + 1u, memory_order_relaxed);
    return true;
}

static bool queue_take(struct queue *queue, struct event *event)
{
    uint32_t tail = atomic_load_explicit(&queue->tail, memory_order_relaxed);

    if (atomic_load_explicit(&queue->head, memory_order_relaxed) == tail)
        return false;
    atomic_signal_fence(memory_order_acquire);
    *event = queue->events[tail % EVENT_QUEUE];
    atomic_signal_fence(memory_order_release);
    atomic_store_explicit(&queue->tail, tail + 1u, memory_order_relaxed);
    return true;
}

static void publish(struct queue *queue, const struct event *event)
{
    const struct hooks *to = &hooks[event->name];

    for (unsigned i = 0; i < to->interrupt_count; i++)
        to->interrupt[i](event);
    if (to->main_count > 0 && !queue_put(queue, event))
        lost = true;
}

void events_publish(enum event_name name, uint32_t argument, uint64_t time_fast)
{
    struct event event = {name, argument, time_fast};

    publish(&from_main, &event);
}

void events_publish_from_interrupt(enum event_name name, uint32_t argument, uint64_t time_fast)
{
    struct event event = {name, argument, time_fast};

    publish(&from_interrupt, &event);
}

static void drain(struct queue *queue)
{
    struct event event;

    for (unsigned n = 0; n < EVENT_QUEUE && queue_take(queue, &event); n++)
        for (unsigned i = 0; i < hooks[event.name].main_count; i++)
            hooks[event.name].main[i](&event);
}

void events_poll(void)
{
    drain(&from_interrupt);
    drain(&from_main);
    if (lost) {
        lost = false;
        log_error(FAULT_TASK_OVERTIME);
    }
}
