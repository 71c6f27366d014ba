/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * What a SCAN line asks for: which axes are fast and slow, in either dialect, and start or stop.
 *
 * The dialect of the MS-2000 gives each of X, Y and Z a role: 1 fast, 2 slow, 0 not used. The other
 * one gives Y the number of the fast and Z that of the slow axis, 9 for none. A line that names X,
 * or holds a 2, can only be the first; one that holds a 9 only the second. SCAN R and T are the same
 * numbers as parameters. X=83 and X=80 ('S', 'P') start and stop, and so do bare S and P.
 */
#ifndef MODULES_SCAN_ROLES_H
#define MODULES_SCAN_ROLES_H

#include "core/parser.h"
#include "core/status.h"

/** As an axis number: no axis. */
#define SCAN_ROLES_NONE 9

struct scan_wish {
    enum { SCAN_NOTHING, SCAN_TOGGLE, SCAN_BEGIN, SCAN_END } action;
    int fast, slow; /* axis numbers or SCAN_ROLES_NONE */
};

/**
 * Read a line.
 *
 * @param wish        In: the axes as they are. Out: as the line has them. A line without arguments
 *                    is SCAN_TOGGLE.
 * @param roles_only  Y and Z without X are roles, too, never axis numbers.
 */
enum status scan_roles_read(const struct request *request, bool roles_only, struct scan_wish *wish);

#endif
