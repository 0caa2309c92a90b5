// SPDX-License-Identifier: Apache-2.0
#include "aureole/film/film.h"

#include "aureole/plugin/registry.h"

namespace aureole {

void Film::read_common(const Properties& p) {
  constexpr double kMaximumSize = 1 << 20;
  width_ = int(p.get_int("width", 768, {1, kMaximumSize}));
  height_ = int(p.get_int("height", 576, {1, kMaximumSize}));
  crop_x_ = int(p.get_int("crop_offset_x", 0, {0, double(width_ - 1)}));
  crop_y_ = int(p.get_int("crop_offset_y", 0, {0, double(height_ - 1)}));
  crop_width_ = int(p.get_int("crop_width", width_ - crop_x_, {1, double(width_ - crop_x_)}));
  crop_height_ = int(p.get_int("crop_height", height_ - crop_y_, {1, double(height_ - crop_y_)}));
  sample_border_ = p.get_bool("sample_border", false);
  const auto filters = p.get_children<Filter>("rfilter");
  if (filters.size() > 1) throw Error(p.where(), "a film has one reconstruction filter");
  if (!filters.empty()) {
    filter_ = filters.front();
  } else {
    const PluginInfo* gaussian = Registry::instance().find("rfilter", "gaussian");
    filter_ = std::dynamic_pointer_cast<Filter>(
        gaussian->create(Properties("gaussian", "", p.where(), p.shared_context(), gaussian)));
  }
  const int outside = sample_border_ ? FilterTable(*filter_).border() : 0;
  sample_area_ = {{float(crop_x_ - outside), float(crop_y_ - outside)},
                  {float(crop_x_ + crop_width_ + outside), float(crop_y_ + crop_height_ + outside)}};
}

}  // namespace aureole
