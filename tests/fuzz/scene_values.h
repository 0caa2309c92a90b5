// SPDX-License-Identifier: Apache-2.0
// Values for the attributes of a scene: plausible ones, extreme ones, and text that is none.
#pragma once

#include <string>
#include <vector>

#include "aureole/plugin/registry.h"
#include "fuzz/corpus.h"

namespace aureole::fuzz {

/// 0, -0, -1, 1e-30, 1e308, 2^31, sometimes nan and other text that is no number.
std::string extreme_number(Random& random);
/// A number as scenes have them.
std::string plausible_number(Random& random);
std::string any_number(Random& random);
std::string any_integer(Random& random);

/// Empty, very long, not ASCII, control characters, references to parameters, names of odd files.
std::string odd_text(Random& random);

/// Another value of the same kind as `old`: in a list of numbers some are replaced, words give way to words.
std::string changed_value(const std::string& old, Random& random);

/// A <transform> with steps of any size.
std::string transform_xml(const std::string& name, Random& random);

/// An element that gives the documented parameter a value of its documented type.
std::string parameter_xml(const ParameterDoc& parameter, const Corpus& corpus, Random& random);

/// A plug-in, of the given family unless it is empty.
const PluginInfo& any_plugin(const std::string& family, Random& random);

/// Escapes for use in an attribute.
std::string escaped(const std::string& text);

}  // namespace aureole::fuzz
