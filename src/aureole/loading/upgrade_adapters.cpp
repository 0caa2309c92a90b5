// SPDX-License-Identifier: Apache-2.0
#include "aureole/loading/upgrade_adapters.h"

#include <algorithm>
#include <numeric>

#include "aureole/loading/values.h"

namespace aureole {

namespace {

Node number(const Node& near, std::string_view name, double value) {
  Node node{"float", {}, {}, near.where, near.file};
  node.set("name", std::string(name));
  node.set("value", number_text(value));
  return node;
}

Node object(const Node& near, std::string_view type) {
  Node node{"bsdf", {}, {}, near.where, near.file};
  node.set("type", std::string(type));
  return node;
}

/// Adds the nested BSDFs k, k + 1, ... with their weights as children of `parent`, a blendbsdf.
void blend(Node& parent, std::vector<Node>& nested, const std::vector<double>& weights, std::size_t k) {
  const double rest = std::accumulate(weights.begin() + std::ptrdiff_t(k) + 1, weights.end(), 0.0);
  const double all = weights[k] + rest;
  Node weight = number(parent, "weight", all > 0 ? rest / all : 0), first = std::move(nested[k]), second;
  if (k + 2 == nested.size()) {
    second = std::move(nested[k + 1]);
  } else {
    second = object(parent, "blendbsdf");
    blend(second, nested, weights, k + 1);
  }
  parent.children = {std::move(weight), std::move(first), std::move(second)};
}

void upgrade_mixture(Node& mixture, Diagnostics& diagnostics) {
  std::vector<Node> nested;
  for (Node& child : mixture.children)
    if (child.tag == "bsdf" || child.tag == "ref") nested.push_back(std::move(child));
  const Node* given = mixture.named_child("weights");
  const Node where = given ? *given : mixture;
  mixture.children.clear();
  mixture.set("type", "blendbsdf");
  try {
    if (!given) throw Error("\"mixturebsdf\" needs the parameter \"weights\"");
    std::vector<double> weights = parse_numbers(where.get("value"));
    if (nested.empty() || weights.size() != nested.size())
      throw Error("there are " + std::to_string(weights.size()) + " weights for " +
                  std::to_string(nested.size()) + " nested BSDFs");
    for (const double w : weights)
      if (!(w >= 0)) throw Error("must not be negative, got " + number_text(w));
    double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    if (sum > 1 + 1e-6) {
      diagnostics.note(where.where, "the weights add up to " + number_text(sum) + " and are divided by it");
      sum = 1;
    } else if (sum < 1 - 1e-6 || nested.size() == 1) {
      // If the weights sum to less than 1, the rest is absorbed: a black BSDF takes the remaining weight.
      nested.push_back(object(mixture, "diffuse"));
      nested.back().children.push_back(number(mixture, "reflectance", 0));
      weights.push_back(std::max(0.0, 1 - sum));
    }
    blend(mixture, nested, weights, 0);
    diagnostics.note(mixture.where, "bsdf \"mixturebsdf\" is replaced by \"blendbsdf\"");
  } catch (const Error& e) {
    diagnostics.error(where.where, "parameter \"weights\": " + e.message());
    mixture.set("type", "null");  // the error has been reported; a null BSDF causes no further errors
  }
}

/// Moves the number and the texture of a <texture type="scale"> into the bumpmap.
void upgrade_bumpmap(Node& bumpmap) {
  for (Node& child : bumpmap.children) {
    if (child.tag != "texture" || child.get("type") != "scale" || bumpmap.named_child("scale")) continue;
    const auto texture = std::find_if(child.children.begin(), child.children.end(),
                                      [](const Node& c) { return c.tag == "texture" || c.tag == "ref"; });
    const Node* scale = child.named_child("scale");
    if (texture == child.children.end() || !scale || child.children.size() != 2) continue;
    Node factor = *scale, inner = std::move(*texture);
    child = std::move(inner);
    bumpmap.children.push_back(std::move(factor));
    return;
  }
}

}  // namespace

void upgrade_adapter(Node& bsdf, Diagnostics& diagnostics) {
  const std::string type = bsdf.get("type");
  if (type == "mixturebsdf") upgrade_mixture(bsdf, diagnostics);
  if (type == "bumpmap") upgrade_bumpmap(bsdf);
  if (type == "normalmap")
    for (Node& child : bsdf.children)
      if (child.tag == "texture") child.set("name", "normalmap");
}

}  // namespace aureole
