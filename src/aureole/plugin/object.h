// SPDX-License-Identifier: Apache-2.0
// `Object`: what every plug-in instance is. It keeps the Properties that made it.
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
  /// The id in the scene file, or an empty string.
  const std::string& id() const;

protected:
  /// For an object that takes over parameters without being built anew.
  void exchange_properties(std::shared_ptr<const Properties>& other) { properties_.swap(other); }

private:
  std::shared_ptr<const Properties> properties_;
};

using ObjectPtr = std::shared_ptr<Object>;

}  // namespace aureole
