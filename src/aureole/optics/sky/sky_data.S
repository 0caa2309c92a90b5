// SPDX-License-Identifier: Apache-2.0
// Embeds the data of the sky model, whose licence is data/LICENSE.hosek_wilkie. AUREOLE_SKY_DATA is the file's path,
// a string literal.
    .section .rodata
    .balign 64
    .global aureole_sky_data
    .hidden aureole_sky_data
    .type aureole_sky_data, %object
aureole_sky_data:
    .incbin AUREOLE_SKY_DATA
    .size aureole_sky_data, . - aureole_sky_data
    .section .note.GNU-stack, "", %progbits
