/* SPDX-License-Identifier: BSD-2-Clause */
/* What this image is for, where the boot program looks for it: behind the first instruction. */
#include <stdint.h>

#include "boot/image.h"
#include "regs.h"

static const struct {
    uint32_t mark, product, map_version;
} mark __attribute__((section(".mark"), used)) = {IMAGE_MARK, IMAGE_PRODUCT, REG_MAP_VERSION};
