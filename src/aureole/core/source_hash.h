// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace aureole {

/// A hash of the library's source, of the compiler and of its options, in hexadecimal digits, which the build writes
/// (tools/source_hash.cmake): tables of one source are not read by a program of another.
extern const char* const kSourceHash;

}  // namespace aureole
