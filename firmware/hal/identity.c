/* SPDX-License-Identifier: BSD-2-Clause */
#include "hal/identity.h"

#include "regs.h"

bool identity_is_known(void)
{
    return identity_magic_read() == REG_MAGIC && identity_map_version_read() == REG_MAP_VERSION;
}

uint32_t identity_map_version(void)
{
    return identity_map_version_read();
}

uint32_t identity_build(void)
{
    return identity_build_id_read();
}

uint32_t identity_clock_rate_hz(void)
{
    return identity_clock_hz_read();
}

uint32_t identity_fast_clock_rate_hz(void)
{
    return identity_fast_clock_hz_read();
}
