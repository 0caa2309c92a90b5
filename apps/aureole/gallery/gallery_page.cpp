// SPDX-License-Identifier: Apache-2.0
#include "gallery/gallery_page.h"

#include <fmt/format.h>

#include "aureole/core/input_file.h"
#include "aureole/core/output_file.h"
#include "aureole/core/version.h"
#include "gallery/gallery_picture.h"

namespace aureole {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr int kResultsVersion = 1;

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '&':
        out += "&amp;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string duration(double s) {
  if (s < 99.5) return fmt::format("{:.1f} s", s);
  const auto n = static_cast<long>(s + 0.5);
  return n < 3600 ? fmt::format("{}:{:02} min", n / 60, n % 60)
                  : fmt::format("{}:{:02}:{:02} h", n / 3600, n / 60 % 60, n % 60);
}

const char* const kStyle = R"css(
:root{color-scheme:dark;--ground:#0d0f14;--card:#161a22;--line:#2a303c;--text:#e8eaf0;--faint:#9aa3b5;--accent:#f0b45a}
*{box-sizing:border-box}
body{margin:0;background:var(--ground);color:var(--text);font:16px/1.55 system-ui,-apple-system,"Segoe UI",Roboto,sans-serif}
header,main,footer{max-width:70rem;margin:0 auto;padding:1rem}
h1{font-weight:600;font-size:clamp(1.6rem,5vw,2.4rem);line-height:1.2;margin:1.2rem 0 .6rem}
h2{font-size:1.35rem;font-weight:600;margin:0 0 .5rem;line-height:1.3}
h2 small{display:block;color:var(--accent);font-size:.8rem;font-weight:500;letter-spacing:.03em}
p{margin:.5rem 0;max-width:48rem}
nav{display:flex;flex-wrap:wrap;gap:.4rem;margin:1rem 0}
nav a{border:1px solid var(--line);border-radius:1rem;padding:.15rem .7rem;font-size:.9rem}
a{color:var(--accent);text-decoration:none}
section{background:var(--card);border:1px solid var(--line);border-radius:.8rem;padding:1.1rem;margin:0 0 1.4rem}
.scroll{overflow-x:auto;margin:.9rem 0}
.grid{display:grid;gap:4px;min-width:min(100%,var(--least,0px))}
.grid img,.plots img{display:block;width:100%;height:auto;border-radius:3px;background:#000}
.plots{display:grid;gap:.6rem;margin:.9rem 0}
.plots img[src$=".svg"]{background:#fff}
figure{margin:0}
figcaption,.label,.note{color:var(--faint);font-size:.82rem;line-height:1.35}
figcaption{padding:.25rem 0 .1rem;text-align:center}
.label{display:flex;align-items:center;justify-content:center;text-align:center}
.label.outer{color:var(--text)}
.gap{margin-left:.5rem}
.drop{margin-top:.5rem}
.missing{display:flex;align-items:center;justify-content:center;aspect-ratio:3/2;border:1px dashed var(--line);color:var(--faint);font-size:.8rem;border-radius:3px}
.agree{border-left:3px solid var(--accent);padding-left:.8rem}
details{margin-top:.6rem}
summary{cursor:pointer;color:var(--faint);font-size:.9rem}
pre{overflow-x:auto;max-height:18rem;background:#0a0c10;border:1px solid var(--line);border-radius:.4rem;padding:.7rem;font-size:.78rem;line-height:1.5}
table{border-collapse:collapse;font-size:.9rem}
td,th{border-bottom:1px solid var(--line);padding:.3rem .8rem;text-align:right}
td:first-child,th:first-child{text-align:left}
@media(max-width:40rem){.plots{grid-template-columns:1fr!important}section{padding:.8rem}body{font-size:15px}.grid{gap:2px}}
)css";

class Page {
public:
  Page(const Gallery& gallery, const GalleryResults& results) : gallery_(gallery), results_(results) {}

  std::string write(const std::string& command) {
    out_ = fmt::format(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
        "content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n<style>{}</style>\n</head>\n"
        "<body>\n<header>\n<h1>{}</h1>\n",
        escaped(gallery_.title), kStyle, escaped(gallery_.title));
    paragraphs(gallery_.introduction);
    out_ += "<nav>";
    for (const GalleryFigure& f : gallery_.figures)
      out_ += fmt::format("<a href=\"#{}\">{}</a>", f.id,
                          escaped(f.counterpart.empty() ? f.title : f.counterpart));
    out_ += "</nav>\n</header>\n<main>\n";
    for (const GalleryFigure& f : gallery_.figures) figure(f);
    out_ += fmt::format(
        "</main>\n<footer class=\"note\"><p>aureole {}, made by <code>{}</code></p></footer>\n"
        "</body>\n</html>\n",
        kVersion, escaped(command));
    return std::move(out_);
  }

private:
  const PictureResult* result(const GalleryPicture& p) const {
    const auto at = results_.pictures.find(p.name);
    return at == results_.pictures.end() ? nullptr : &at->second;
  }

  void paragraphs(const std::string& text, const char* style = "") {
    for (std::size_t from = 0; from < text.size();) {
      std::size_t end = std::min(text.find('\n', from), text.size());
      if (end > from) out_ += fmt::format("<p{}>{}</p>\n", style, escaped(text.substr(from, end - from)));
      from = end + 1;
    }
  }

  void figure(const GalleryFigure& f) {
    out_ += fmt::format("<section id=\"{}\">\n<h2><small>{}</small>{}</h2>\n", f.id, escaped(f.counterpart),
                        escaped(f.title));
    paragraphs(f.caption);
    if (!f.missing.empty()) paragraphs("Not rendered: " + f.missing);
    double seconds = 0;
    for (const PictureTable& t : f.tables) seconds += table(t);
    for (const GalleryPlot& p : f.plots) seconds += plot(p);
    paragraphs(f.agreement, " class=\"agree\"");
    commands(f, seconds);
    out_ += "</section>\n";
  }

  static std::string label(const std::vector<Axis>& axes, std::size_t i, bool first_of_block) {
    // Label of the inner axis, and of each outer axis where its value changes.
    std::string text = axes.back()[i % axes.back().size()].label;
    if (axes.size() > 1 && first_of_block) {
      std::string outer;
      std::size_t rest = i / axes.back().size();
      for (std::size_t k = axes.size() - 1; k-- > 0; rest /= axes[k].size())
        outer = axes[k][rest % axes[k].size()].label + (outer.empty() ? "" : ", " + outer);
      return fmt::format("<span><b>{}</b><br>{}</span>", escaped(outer), escaped(text));
    }
    return fmt::format("<span>{}</span>", escaped(text));
  }

  void picture(const GalleryPicture& p, const std::string& classes, bool numbers) {
    const PictureResult* r = result(p);
    out_ += fmt::format("<figure class=\"{}\">", classes);
    if (!r) {
      out_ += "<div class=\"missing\">not rendered yet</div></figure>\n";
      return;
    }
    const PictureEffort& e = p.effort[r->size];
    out_ += fmt::format(
        "<a href=\"{0}.png\"><img src=\"{0}.png\" width=\"{1}\" height=\"{2}\" loading=\"lazy\" alt=\"{0}\" "
        "title=\"{3} samples per pixel in {4}\"></a>",
        p.name, e.width, e.height, r->samples, duration(r->seconds));
    if (numbers) out_ += fmt::format("<figcaption>{} spp, {}</figcaption>", r->samples, duration(r->seconds));
    out_ += "</figure>\n";
  }

  double table(const PictureTable& t) {
    double seconds = 0;
    const auto add = [&](const GalleryPicture& p) {
      if (const PictureResult* r = result(p)) seconds += r->seconds + r->load_seconds;
    };
    for (const GalleryPicture& p : t.pictures) add(p);
    paragraphs(t.caption);
    if (t.reference) {
      add(*t.reference);
      out_ += "<div style=\"max-width:34rem\">";
      picture(*t.reference, "", false);
      if (const PictureResult* r = result(*t.reference))
        out_ += fmt::format("<p class=\"note\">Reference: {} samples per pixel, {}.</p>", r->samples,
                            duration(r->seconds));
      out_ += "</div>\n";
    }
    const std::size_t columns = PictureTable::count(t.columns), rows = PictureTable::count(t.rows);
    const std::size_t inner_columns = t.columns.empty() ? 1 : t.columns.back().size(),
                      inner_rows = t.rows.empty() ? 1 : t.rows.back().size();
    const bool numbers = t.pictures.size() <= 6 && !t.reference;
    out_ += fmt::format(
        "<div class=\"scroll\"><div class=\"grid\" style=\"grid-template-columns:{}repeat({},1fr);"
        "--least:{}px\">\n",
        t.rows.empty() ? "" : "auto ", columns, columns > 2 ? 72 * columns : 0);
    if (!t.columns.empty()) {
      if (!t.rows.empty()) out_ += "<div></div>";
      for (std::size_t j = 0; j < columns; ++j)
        out_ += fmt::format("<div class=\"label{}\">{}</div>", j && j % inner_columns == 0 ? " gap" : "",
                            label(t.columns, j, j % inner_columns == 0));
      out_ += "\n";
    }
    for (std::size_t i = 0; i < rows; ++i) {
      const bool drop = i && t.rows.size() > 1 && i % inner_rows == 0;
      if (!t.rows.empty())
        out_ += fmt::format("<div class=\"label{}\">{}</div>", drop ? " drop" : "",
                            label(t.rows, i, i % inner_rows == 0));
      for (std::size_t j = 0; j < columns; ++j)
        picture(t.pictures[i * columns + j],
                std::string(j && t.columns.size() > 1 && j % inner_columns == 0 ? "gap" : "") +
                    (drop ? " drop" : ""),
                numbers);
    }
    out_ += "</div></div>\n";
    if (t.reference) errors(t);
    return seconds;
  }

  void errors(const PictureTable& t) {
    out_ +=
        "<div class=\"scroll\"><table><tr><th></th><th>samples per pixel</th><th>seconds</th><th>relative "
        "RMSE"
        "</th><th>time for the same error</th></tr>\n";
    // Least cost of the strategies; the cost of a strategy is error^2 x time.
    double best = INFINITY;
    const auto cost = [](const PictureResult& r) { return *r.relative_rmse * *r.relative_rmse * r.seconds; };
    for (const GalleryPicture& p : t.pictures)
      if (const PictureResult* r = result(p); r && r->relative_rmse) best = std::min(best, cost(*r));
    const std::size_t columns = PictureTable::count(t.columns);
    for (std::size_t i = 0; i < t.pictures.size(); ++i) {
      const PictureResult* r = result(t.pictures[i]);
      std::string name = t.pictures[i].name;
      if (!t.columns.empty()) name = label(t.columns, i % columns, true);
      if (!t.rows.empty()) name = label(t.rows, i / columns, true) + " " + (t.columns.empty() ? "" : name);
      if (!r || !r->relative_rmse)
        out_ += fmt::format("<tr><td>{}</td><td></td><td></td><td></td><td></td></tr>\n", name);
      else
        out_ +=
            fmt::format("<tr><td>{}</td><td>{}</td><td>{:.2f}</td><td>{:.4f}</td><td>{:.2f} x</td></tr>\n",
                        name, r->samples, r->seconds, *r->relative_rmse, cost(*r) / best);
    }
    out_ += "</table></div>\n";
  }

  double plot(const GalleryPlot& p) {
    paragraphs(p.caption);
    const auto at = results_.plots.find(p.name);
    if (at == results_.plots.end()) {
      out_ += "<div class=\"missing\">not made yet</div>\n";
      return 0;
    }
    const PlotResult& plot = at->second.plot;
    out_ +=
        fmt::format("<div class=\"plots\" style=\"grid-template-columns:repeat({},1fr)\">\n", plot.columns);
    for (const PlotFile& f : plot.files)
      out_ +=
          fmt::format("<figure><a href=\"{0}\"><img src=\"{0}\" loading=\"lazy\" alt=\"\"></a>{1}</figure>\n",
                      f.file, f.caption.empty() ? "" : "<figcaption>" + escaped(f.caption) + "</figcaption>");
    out_ += "</div>\n";
    return at->second.seconds;
  }

  void commands(const GalleryFigure& f, double seconds) {
    std::string text;
    std::size_t count = 0, done = 0;
    const auto add = [&](const GalleryPicture& p) {
      const PictureResult* r = result(p);
      text += render_command(p, r ? r->size : kPreviewSize);
      if (r) text += fmt::format("  # {}", duration(r->seconds + r->load_seconds));
      text += "\n";
      ++count, done += r != nullptr;
    };
    for (const PictureTable& t : f.tables) {
      if (t.reference) add(*t.reference);
      for (const GalleryPicture& p : t.pictures) add(p);
    }
    std::string summary;
    if (count > 0)
      summary = fmt::format("{} picture{}, {}", count, count == 1 ? "" : "s", duration(seconds));
    else
      summary = duration(seconds);
    if (done < count) summary += fmt::format(" for the {} that are done", done);
    if (text.empty())
      out_ += fmt::format("<p class=\"note\">Computed in {}.</p>\n", summary);
    else
      out_ += fmt::format("<details><summary>Commands ({})</summary><pre>{}</pre></details>\n", summary,
                          escaped(text));
  }

  const Gallery& gallery_;
  const GalleryResults& results_;
  std::string out_;
};

}  // namespace

GalleryResults GalleryResults::load(const std::filesystem::path& file) {
  GalleryResults results;
  if (!fault_of_input(file).empty()) return results;
  try {
    const OrderedJson j = OrderedJson::parse(read_text_file(file, kMaxJsonBytes));
    if (j.at("version").get<int>() != kResultsVersion) return {};
    const auto size = [](const OrderedJson& r) { return r.at("size") == "full" ? kFullSize : kPreviewSize; };
    for (const auto& [name, r] : j.at("pictures").items()) {
      PictureResult p{r.at("key").get<std::string>(),      size(r),
                      r.at("samples").get<std::int64_t>(), r.at("seconds").get<double>(),
                      r.at("load_seconds").get<double>(),  {}};
      if (r.contains("relative_rmse")) p.relative_rmse = r["relative_rmse"].get<double>();
      results.pictures[name] = p;
    }
    for (const auto& [name, r] : j.at("plots").items()) {
      PlotRecord p{r.at("key").get<std::string>(), size(r), r.at("seconds").get<double>(), {}};
      p.plot.columns = r.at("columns").get<int>();
      for (const auto& f : r.at("files"))
        p.plot.files.push_back({f.at("file").get<std::string>(), f.at("caption").get<std::string>()});
      results.plots[name] = p;
    }
  } catch (const OrderedJson::exception&) {
    return {};
  }
  return results;
}

void GalleryResults::save(const std::filesystem::path& file) const {
  OrderedJson j;
  j["version"] = kResultsVersion;
  j["pictures"] = OrderedJson::object();
  for (const auto& [name, r] : pictures) {
    OrderedJson& p = j["pictures"][name];
    p = {{"key", r.key},
         {"size", name_of(r.size)},
         {"samples", r.samples},
         {"seconds", r.seconds},
         {"load_seconds", r.load_seconds}};
    if (r.relative_rmse) p["relative_rmse"] = *r.relative_rmse;
  }
  j["plots"] = OrderedJson::object();
  for (const auto& [name, r] : plots) {
    OrderedJson files = OrderedJson::array();
    for (const PlotFile& f : r.plot.files) files.push_back({{"file", f.file}, {"caption", f.caption}});
    j["plots"][name] = {{"key", r.key},
                        {"size", name_of(r.size)},
                        {"seconds", r.seconds},
                        {"columns", r.plot.columns},
                        {"files", files}};
  }
  write_file_atomically(file, j.dump(1) + "\n");
}

std::string gallery_page(const Gallery& gallery, const GalleryResults& results, const std::string& command) {
  return Page(gallery, results).write(command);
}

}  // namespace aureole
