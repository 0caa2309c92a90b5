// SPDX-License-Identifier: Apache-2.0
// Builds plug-in instances from snippets of XML, as in the examples of their documentation, without a scene
// reader.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"

namespace aureole::testing {

/// A context for [min_nm, max_nm]; `diagnostics` may be null and must outlive what is built.
std::shared_ptr<const BuildContext> make_context(double min_nm = 360, double max_nm = 830,
                                                 Diagnostics* diagnostics = nullptr);

/// Finds the file that a `filename` in a snippet stands for.
using FileResolver = std::function<std::filesystem::path(const std::string&)>;

/// The parameters in `xml`, for classes that are not registered.
Properties read_properties(const std::string& xml,
                           const std::shared_ptr<const BuildContext>& context = make_context(),
                           const FileResolver& resolve = {});

/// The instance described by `xml`, with nested objects. Throws Error for wrong input and for parameters that
/// nothing read.
ObjectPtr build_object(const std::string& xml,
                       const std::shared_ptr<const BuildContext>& context = make_context(),
                       const FileResolver& resolve = {});

/// Builds an object of family T; throws Error if it is something else.
template <class T>
std::shared_ptr<T> build(const std::string& xml,
                         const std::shared_ptr<const BuildContext>& context = make_context(),
                         const FileResolver& resolve = {}) {
  auto object = std::dynamic_pointer_cast<T>(build_object(xml, context, resolve));
  if (!object) throw Error(std::string("not ") + T::kFamily + ": " + xml);
  return object;
}

}  // namespace aureole::testing
