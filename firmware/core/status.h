/* SPDX-License-Identifier: BSD-2-Clause */
/** Outcome of a command. Negative values are the numbers of the error replies (`:N-4` is -4). */
#ifndef CORE_STATUS_H
#define CORE_STATUS_H

enum status {
    STATUS_OK = 0,      /* done; without reply text the reply is the bare acknowledge */
    STATUS_PENDING = 1, /* the reply goes on: call `run` again when its text has left */
    STATUS_SILENT = 2,  /* done, and no reply at all (INFO of an axis that is not fitted) */

    STATUS_UNKNOWN_COMMAND = -1, /* no command of this name is built */
    STATUS_UNKNOWN_AXIS = -2,    /* the command has no such letter, or the axis is not fitted */
    STATUS_MISSING = -3,         /* an argument, an axis letter or a number is missing */
    STATUS_RANGE = -4,           /* a value or a form of argument the parameter does not take */
    STATUS_FAILED = -5,          /* correct, but it could not be done now */
    STATUS_UNDEFINED = -6,       /* wrong in another way: stray characters, line too long */
    STATUS_HALTED = -21,         /* reply to HALT when it stopped a commanded move */
};

#endif
