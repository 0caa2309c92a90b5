// SPDX-License-Identifier: Apache-2.0
#include "aureole/transport/path_log.h"

#include <fmt/format.h>

#include "aureole/bsdf/bsdf.h"
#include "aureole/emitter/light.h"
#include "aureole/medium/medium.h"
#include "aureole/scene/surface.h"

namespace aureole {

namespace {

std::string coordinates(const Vec3& v) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x, v.y, v.z); }

}  // namespace

std::string to_string(const PathEvent& e) {
  using Kind = PathEvent::Kind;
  switch (e.kind) {
    case Kind::start: {
      const std::string from = fmt::format("from {} along {}", coordinates(e.p), coordinates(e.d));
      if (e.in_medium) return fmt::format("  medium \"{}\": {}", e.in_medium->id(), from);
      return fmt::format("  emitter \"{}\", part {}: {}", e.light->properties().type(), e.part, from);
    }
    case Kind::surface:
      return fmt::format("  depth {}: {} \"{}\" at {}, bsdf {}, throughput {:.6g}", e.depth,
                         e.point->shape->properties().type(), e.point->shape->id(), coordinates(e.p),
                         e.point->surface->bsdf->properties().type(), e.throughput);
    case Kind::medium:
      return fmt::format("  depth {}: scattered by {} \"{}\" at {}, throughput {:.6g}", e.depth,
                         e.in_medium->properties().type(), e.in_medium->id(), coordinates(e.p), e.throughput);
    case Kind::exit:
      return fmt::format("  enters, and leaves at {}, throughput {:.6g}", coordinates(e.p), e.throughput);
    case Kind::edge:
      return fmt::format("  depth {}: edge at {}", e.depth, coordinates(e.p));
    case Kind::escape:
      return fmt::format("  depth {}: escapes along {}", e.depth, coordinates(e.d));
    case Kind::emission:
      return fmt::format("  emission: mean {:.6g}", mean(e.estimate));
    case Kind::connection:
      return fmt::format("  {}: {} mean {:.6g}", e.vertex > 0 ? "connection" : "light",
                         e.open ? "visible" : "occluded", mean(e.estimate));
    case Kind::sensor:
      return fmt::format("  sensor at ({:.6g}, {:.6g}) on the film: {} mean {:.6g}", e.film.x, e.film.y,
                         e.open ? "visible" : "occluded", e.open ? mean(e.estimate) : 0.f);
    case Kind::other:
      return fmt::format("  {}: mean {:.6g}", e.text, mean(e.estimate));
  }
  return {};
}

}  // namespace aureole
