#include "engine/app/report/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/app/report/assets.h"
#include "io/picture/svg_text.h"

namespace ricci::app {
namespace {

constexpr std::size_t kMostInvariants = 3000, kMostFailures = 1000;  // rows of a page

struct VerdictWords {
    const char *mark, *word, *style;
};
VerdictWords words_of(Verdict verdict) {
    switch (verdict) {
        case Verdict::holds:
            return {"&#10003;", "holds", "holds"};
        case Verdict::look:
            return {"!", "look", "look"};
        case Verdict::fails:
            return {"&#10007;", "fails", "fails"};
        case Verdict::told:
            break;
    }
    return {"&#183;", "told", "told"};
}

/// JSON inside a script element: no "<" may end it.
std::string embedded_json(const nlohmann::json& object) {
    std::string text = object.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace), safe;
    for (const char c : text) safe += c == '<' ? std::string("\\u003c") : std::string(1, c);
    return safe;
}

std::string colour_table(ColourMap map) {
    constexpr int kColours = 255;
    std::string table;
    for (int i = 0; i < kColours; ++i) {
        const Colour c = colour_at(map, static_cast<double>(i) / (kColours - 1));
        table += fmt::format("{:02x}{:02x}{:02x}", c.red, c.green, c.blue);
    }
    return table;
}

std::string table_html(const PageTable& table) {
    const auto style = [&](std::size_t k) {
        return k < table.numeric.size() && table.numeric[k] ? " class=\"number\"" : "";
    };
    std::string html = "<div class=\"wide\"><table>\n";
    if (!table.caption.empty()) html += "<caption>" + xml_text(table.caption) + "</caption>\n";
    html += "<thead><tr>";
    for (std::size_t k = 0; k < table.head.size(); ++k)
        html += fmt::format("<th scope=\"col\"{}>{}</th>", style(k), xml_text(table.head[k]));
    html += "</tr></thead>\n<tbody>\n";
    for (const std::vector<std::string>& row : table.rows) {
        html += "<tr>";
        for (std::size_t k = 0; k < row.size(); ++k) html += fmt::format("<td{}>{}</td>", style(k), row[k]);
        html += "</tr>\n";
    }
    return html + "</tbody></table></div>\n";
}

/// The licence of what the page carries along asks for this.
constexpr const char* kThreeLicence =
    "/* three.js r111 and its examples OrbitControls, LineSegments2, LineMaterial and what these need.\n"
    "The MIT License. Copyright (c) 2010-2019 three.js authors\n"
    "Permission is hereby granted, free of charge, to any person obtaining a copy of this software and "
    "associated\n"
    "documentation files (the \"Software\"), to deal in the Software without restriction, including without "
    "limitation\n"
    "the rights to use, copy, modify, merge, publish, distribute, sublicense, and/or sell copies of the "
    "Software, and to\n"
    "permit persons to whom the Software is furnished to do so, subject to the following conditions: The "
    "above copyright\n"
    "notice and this permission notice shall be included in all copies or substantial portions of the "
    "Software.\n"
    "THE SOFTWARE IS PROVIDED \"AS IS\", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR IMPLIED, INCLUDING BUT NOT "
    "LIMITED TO\n"
    "THE WARRANTIES OF MERCHANTABILITY, FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT "
    "SHALL THE\n"
    "AUTHORS OR COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER LIABILITY, WHETHER IN AN ACTION "
    "OF CONTRACT,\n"
    "TORT OR OTHERWISE, ARISING FROM, OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS "
    "IN THE\n"
    "SOFTWARE. */\n";

}  // namespace

std::string number_text(double value) {
    if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
    if (std::isnan(value)) return "\u2013";
    return fmt::format("{:.6g}", value == 0.0 ? 0.0 : value);
}

Invariant bounded(const std::string& item, const std::string& result, const std::string& quantity,
                  double value, double good, double bad) {
    Invariant i{item, result, quantity, number_text(value), fmt::format("{:.3g}", good), Verdict::holds, ""};
    if (std::isnan(value)) {
        i.verdict = Verdict::look;
        i.note = "not recorded";
    } else if (value < 0.0) {
        i.verdict = Verdict::fails;
        i.note = "negative";
    } else if (value > good) {
        i.verdict = value > bad ? Verdict::fails : Verdict::look;
    }
    return i;
}

Invariant none_of(const std::string& item, const std::string& result, const std::string& quantity,
                  const std::optional<std::int64_t>& count, Verdict otherwise) {
    if (count) return none_of(item, result, quantity, *count, otherwise);
    return {item, result, quantity, "", "0", Verdict::look, "not recorded"};
}

Invariant none_of(const std::string& item, const std::string& result, const std::string& quantity,
                  std::int64_t count, Verdict otherwise) {
    return {item, result, quantity, fmt::format("{}", count), "0", count == 0 ? Verdict::holds : otherwise,
            ""};
}

std::string ReportPage::text(const std::string& words) {
    return xml_text(words);
}

void ReportPage::begin_section(const std::string& title, const std::string& summary) {
    const int k = ++sections_;
    contents_ += fmt::format("<li><a href=\"#s{}\">{}</a></li>\n", k, text(title));
    body_ += fmt::format("<section id=\"s{}\">\n<h2>{}</h2>\n", k, text(title));
    if (!summary.empty()) paragraph(summary);
}

void ReportPage::end_section() {
    body_ += "</section>\n";
}

void ReportPage::begin_part(const std::string& title, const std::string& facts) {
    body_ += "<article>\n";
    if (!title.empty()) body_ += fmt::format("<h3>{}</h3>\n", text(title));
    if (!facts.empty()) body_ += fmt::format("<p class=\"facts\">{}</p>\n", text(facts));
}

void ReportPage::end_part() {
    body_ += "</article>\n";
}

void ReportPage::begin_grid() {
    body_ += "<div class=\"grid\">\n";
}

void ReportPage::end_grid() {
    body_ += "</div>\n";
}

void ReportPage::begin_details(const std::string& title) {
    body_ += fmt::format("<details><summary>{}</summary>\n", text(title));
}

void ReportPage::end_details() {
    body_ += "</details>\n";
}

void ReportPage::paragraph(const std::string& words) {
    body_ += "<p>" + text(words) + "</p>\n";
}

void ReportPage::note(const std::string& words) {
    body_ += "<p class=\"note\">" + text(words) + "</p>\n";
}

void ReportPage::table(const PageTable& table) {
    body_ += table_html(table);
}

PageFigure ReportPage::make_figure(const std::string& label, const SvgPicture& picture,
                                   const std::string& caption, const std::string& link) {
    return {label, picture.embedded(fmt::format("p{}", ++pictures_)), caption, link};
}

void ReportPage::figure(const SvgPicture& picture, const std::string& caption, const std::string& link) {
    figures({make_figure("", picture, caption, link)});
}

void ReportPage::figures(const std::vector<PageFigure>& figures) {
    if (figures.empty()) return;
    if (figures.size() > 1) body_ += "<div class=\"tabs\">\n";
    for (const PageFigure& f : figures) {
        body_ += "<figure";
        if (!f.label.empty()) body_ += fmt::format(" data-tab=\"{}\"", text(f.label));
        if (!f.link.empty()) body_ += fmt::format(" data-link=\"{}\"", text(f.link));
        body_ += ">\n" + f.svg;
        if (!f.caption.empty()) body_ += "<figcaption>" + text(f.caption) + "</figcaption>\n";
        body_ += "</figure>\n";
    }
    if (figures.size() > 1) body_ += "</div>\n";
}

void ReportPage::view(const Scene& scene) {
    body_ += fmt::format(
        "<figure class=\"view\" data-scene=\"{}\"><noscript>A view in space of {}, which needs "
        "scripts.</noscript></figure>\n",
        scenes_.size(), text(scene.title));
    scenes_.push_back(scene_json(scene, bytes_));
}

std::string ReportPage::thumbnail(const ViewMesh& mesh, const std::string& name) {
    Scene scene;
    scene.mesh = mesh;
    scene.title = name;
    thumbnails_.push_back(scene_json(scene, bytes_));
    return fmt::format(
        "<span class=\"thumbnail\" data-thumbnail=\"{}\" role=\"img\" aria-label=\"{}\"></span>",
        thumbnails_.size() - 1, text(name));
}

void ReportPage::failure(const std::string& item, const std::string& stage, const std::string& status,
                         const std::string& message) {
    failures_.rows.push_back({text(item), text(stage), text(status), text(message)});
}

std::size_t ReportPage::count(Verdict verdict) const {
    return static_cast<std::size_t>(std::count_if(invariants_.begin(), invariants_.end(),
                                                  [&](const Invariant& i) { return i.verdict == verdict; }));
}

std::string ReportPage::summary_html() const {
    const auto cell = [&](Verdict verdict, const char* words) {
        const VerdictWords w = words_of(verdict);
        return fmt::format("<li class=\"{}\"><b>{}&nbsp;{}</b> {}</li>\n", w.style, w.mark, count(verdict),
                           words);
    };
    std::string html = "<ul class=\"summary\">\n";
    html += fmt::format("<li class=\"{}\"><b>{}&nbsp;{}</b> failures recorded</li>\n",
                        failures_.rows.empty() ? "holds" : "fails",
                        failures_.rows.empty() ? "&#10003;" : "&#10007;", failures_.rows.size());
    html += cell(Verdict::fails, "checks fail") + cell(Verdict::look, "to look at") +
            cell(Verdict::holds, "checks hold");
    return html + "</ul>\n";
}

/// Rows of the checks that `wanted` asks for, at most so many.
PageTable ReportPage::checks_table(const std::function<bool(Verdict)>& wanted) const {
    PageTable table{"", {"verdict", "item", "result", "quantity", "value", "bound", "note"}, {}, {}};
    table.numeric = {false, false, false, false, true, true, false};
    for (const Invariant& i : invariants_) {
        if (!wanted(i.verdict)) continue;
        if (table.rows.size() == kMostInvariants) {
            table.caption = fmt::format("The first {}.", kMostInvariants);
            break;
        }
        const VerdictWords w = words_of(i.verdict);
        table.rows.push_back(
            {fmt::format("<span class=\"verdict {}\">{}&nbsp;{}</span>", w.style, w.mark, w.word),
             text(i.item), text(i.result), text(i.quantity), text(i.value), text(i.bound), text(i.note)});
    }
    return table;
}

std::string ReportPage::invariants_html() const {
    std::string html = "<section id=\"checks\">\n<h2>Checks</h2>\n";
    if (!failures_.rows.empty()) {
        html += "<h3>What failed</h3>\n";
        PageTable failures = failures_;
        if (failures.rows.size() > kMostFailures) {
            failures.caption =
                fmt::format("The first {} of {} failures.", kMostFailures, failures.rows.size());
            failures.rows.resize(kMostFailures);
        }
        html += table_html(failures);
    }
    const std::size_t fail = count(Verdict::fails), look = count(Verdict::look),
                      rest = invariants_.size() - fail - look;
    if (fail > 0)
        html += "<h3>Checks that fail</h3>\n" +
                table_html(checks_table([](Verdict v) { return v == Verdict::fails; }));
    if (look > 0)
        html += "<h3>Checks to look at</h3>\n" +
                table_html(checks_table([](Verdict v) { return v == Verdict::look; }));
    if (rest > 0)
        html +=
            fmt::format("<details><summary>{} checks that hold, and facts</summary>\n", rest) +
            table_html(checks_table([](Verdict v) { return v == Verdict::holds || v == Verdict::told; })) +
            "</details>\n";
    if (invariants_.empty()) html += "<p>Nothing to check.</p>\n";
    return html + "</section>\n";
}

std::string ReportPage::provenance_html(const PageOrigin& origin) const {
    std::string html = "<section id=\"provenance\">\n<h2>Where this comes from</h2>\n<dl>\n";
    for (const auto& [name, value] : origin.facts)
        if (!value.empty()) html += fmt::format("<dt>{}</dt><dd>{}</dd>\n", text(name), text(value));
    html += "</dl>\n<h3>To reproduce and to check it</h3>\n<pre>";
    for (const std::string& command : origin.commands) html += text(command) + "\n";
    html += "</pre>\n";
    if (!origin.config.empty())
        html += "<details><summary>Configuration</summary><pre>" + text(origin.config) + "</pre></details>\n";
    return html + "</section>\n";
}

std::string ReportPage::document(const PageOrigin& origin) const {
    const std::string title = text(origin.file) + " &ndash; Ricci";
    std::string page =
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src "
        "'unsafe-inline'; "
        "style-src 'unsafe-inline'; img-src data: blob:; base-uri 'none'; form-action 'none'\">\n";
    page +=
        "<title>" + title + "</title>\n<style>\n" + std::string(report_css()) + "</style>\n</head>\n<body>\n";
    page += fmt::format("<header>\n<h1>{}</h1>\n<p>{}</p>\n{}</header>\n", text(origin.file),
                        text(origin.kind), summary_html());
    page += "<nav aria-label=\"Contents\"><ul>\n<li><a href=\"#checks\">Checks</a></li>\n" + contents_ +
            "<li><a href=\"#provenance\">Where this comes from</a></li>\n</ul></nav>\n";
    page += "<main>\n" + invariants_html() + body_ + provenance_html(origin) + "</main>\n";
    if (scenes_.empty() && thumbnails_.empty())
        return page + "<script>\n" + std::string(report_script()) + "</script>\n</body>\n</html>\n";
    const nlohmann::json data = {{"scenes", scenes_},
                                 {"thumbnails", thumbnails_},
                                 {"sequential", colour_table(ColourMap::sequential)},
                                 {"diverging", colour_table(ColourMap::diverging)}};
    page += "<script type=\"application/json\" id=\"ricci-data\">" + embedded_json(data) + "</script>\n";
    page += "<script type=\"application/octet-stream\" id=\"ricci-bytes\">" + bytes_.packed() + "</script>\n";
    page += "<script>\n" + std::string(kThreeLicence) + std::string(three_script()) + "\n</script>\n";
    page += "<script>\n" + std::string(three_extras()) + "\n</script>\n";
    return page + "<script>\n" + std::string(report_script()) + "</script>\n</body>\n</html>\n";
}

}  // namespace ricci::app
