/* SPDX-License-Identifier: BSD-2-Clause */
/* Group 0: echo, reset, sizes of buffers, which boot loader this is. */
#include "boot/frame.h"
#include "boot/smp.h"

#include <string.h>

enum { ECHO = 0, RESET = 5, PARAMETERS = 6, BOOT_LOADER = 8 };

/* MCUboot's number for images that are loaded to RAM. */
#define MODE_RAM_LOAD 6u

static bool reset_wanted;

void smp_os_init(void)
{
    reset_wanted = false;
}

bool smp_reset_wanted(void)
{
    return reset_wanted;
}

static bool put_boot_loader(const struct smp_request *request, zcbor_state_t *response)
{
    if (request->query.value == NULL)
        return smp_put_text(response, "bootloader", "MCUboot");
    return zcbor_tstr_put_lit(response, "mode") && zcbor_uint32_put(response, MODE_RAM_LOAD) &&
           zcbor_tstr_put_lit(response, "no-downgrade") && zcbor_bool_put(response, true);
}

struct smp_result smp_os(const struct smp_request *request, zcbor_state_t *response)
{
    bool fits;

    if (request->command == ECHO && request->d.value != NULL) {
        fits = zcbor_tstr_put_lit(response, "r") && zcbor_tstr_encode(response, &request->d);
    } else if (request->command == RESET && request->write) {
        reset_wanted = true;
        fits = true;
    } else if (request->command == PARAMETERS && !request->write) {
        fits = zcbor_tstr_put_lit(response, "buf_size") && zcbor_uint32_put(response, FRAME_PACKET_BYTES) &&
               zcbor_tstr_put_lit(response, "buf_count") && zcbor_uint32_put(response, 1);
    } else if (request->command == BOOT_LOADER && !request->write) {
        fits = put_boot_loader(request, response);
    } else {
        return smp_refuse(SMP_NOT_SUPPORTED, "no such command");
    }
    return fits ? SMP_DONE : smp_refuse(SMP_INVALID, "response too long");
}
