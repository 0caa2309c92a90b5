// SPDX-License-Identifier: Apache-2.0
// `Object`: the base class of all plug-ins. It keeps the Properties from which it was made.
#pragma once

#include <memory>
#include <string>

namespace aureole {

class Properties;

class Object {
public:
  explicit Object(const Properties& properties);
  virtual ~Object();
  Object(const Object&) = delete;
  Object& operator=(const Object&) = delete;

  /// The parameters this object was made from.
  const Properties& properties() const { return *properties_; }
  const std::shared_ptr<const Properties>& shared_properties() const { return properties_; }
  /// The id in the scene file, or an empty string.
  const std::string& id() const;

private:
  std::shared_ptr<const Properties> properties_;
};

using ObjectPtr = std::shared_ptr<Object>;

}  // namespace aureole
