// SPDX-License-Identifier: Apache-2.0
// Embeds the measured paints, whose author and licence are in data/LICENSE.kimera. AUREOLE_KIMERA_DATA is the
// file's path, a string literal.
    .section .rodata
    .balign 64
    .global aureole_kimera_data
    .hidden aureole_kimera_data
    .type aureole_kimera_data, %object
aureole_kimera_data:
    .incbin AUREOLE_KIMERA_DATA
    .byte 0
    .size aureole_kimera_data, . - aureole_kimera_data
    .section .note.GNU-stack, "", %progbits
