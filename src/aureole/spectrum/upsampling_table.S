// SPDX-License-Identifier: Apache-2.0
// Embeds the table of spectral upsampling. AUREOLE_UPSAMPLING_TABLE is the file's path, a string literal.
    .section .rodata
    .balign 64
    .global aureole_upsampling_table
    .hidden aureole_upsampling_table
    .type aureole_upsampling_table, %object
aureole_upsampling_table:
    .incbin AUREOLE_UPSAMPLING_TABLE
    .size aureole_upsampling_table, . - aureole_upsampling_table
    .global aureole_upsampling_table_end
    .hidden aureole_upsampling_table_end
aureole_upsampling_table_end:
    .zero 16  // padding, since nodes of three numbers are read four numbers at a time
    .section .note.GNU-stack, "", %progbits
