/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/modules.h"

#include <stddef.h>

#include "modules/identity.h"
#include "modules/settings.h"

/* Start-up runs `init` in this order. */
const struct module *const firmware_modules[] = {
    &identity_module,
    &settings_module,
    NULL,
};

/* First come, first asked. */
const struct claim firmware_claims[] = {
    {0},
};
