// One self-contained page: headings, tables, pictures, interactive views, and a list of everything that was
// checked. The page reads without scripts; those add the views, sorting and links between views and pictures.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "engine/app/report/scene.h"
#include "io/picture/svg.h"

namespace ricci::app {

/// holds: within its bound. look: beyond it, but told and no error (a near-tie, a warning). fails: an error.
/// told: a fact without a bound.
enum class Verdict : std::uint8_t { holds, look, fails, told };

/// Something that is true of a sound result, and how far it is.
struct Invariant {
    std::string item, result, quantity, value, bound;
    Verdict verdict = Verdict::told;
    std::string note{};
};

/// A number and the bound it should stay below: fails beyond `bad` (and below zero), look between the two,
/// and for NaN, which stands for "not recorded".
Invariant bounded(const std::string& item, const std::string& result, const std::string& quantity,
                  double value, double good, double bad);
/// A count that should be zero; `otherwise` when it is not.
Invariant none_of(const std::string& item, const std::string& result, const std::string& quantity,
                  std::int64_t count, Verdict otherwise);

/// The same of a count that the file may lack: then look.
Invariant none_of(const std::string& item, const std::string& result, const std::string& quantity,
                  const std::optional<std::int64_t>& count, Verdict otherwise);

/// A picture and what is said below it.
struct PageFigure {
    std::string label;  // of its tab where there are several
    std::string svg;    // SvgPicture::embedded
    std::string caption{};
    std::string link{};
};

struct PageTable {
    std::string caption;
    std::vector<std::string> head;
    std::vector<std::vector<std::string>> rows;  // HTML
    std::vector<bool> numeric{};                 // per column: set on the right, in figures of one width
};

/// What a page says about the file it was made of.
struct PageOrigin {
    std::string file, kind;                                  // kind: "results of a sweep", ...
    std::vector<std::pair<std::string, std::string>> facts;  // provenance
    std::string config;                                      // TOML
    std::vector<std::string> commands;                       // to reproduce and to check
};

class ReportPage {
  public:
    /// Text becomes HTML text.
    static std::string text(const std::string& words);

    void begin_section(const std::string& title, const std::string& summary = "");
    void end_section();
    /// Without a title where the section is about one thing.
    void begin_part(const std::string& title, const std::string& facts = "");
    void end_part();
    void begin_grid();
    void end_grid();
    void begin_details(const std::string& title);
    void end_details();
    void paragraph(const std::string& words);
    /// A remark that something is left out or simplified.
    void note(const std::string& words);
    void table(const PageTable& table);
    void figure(const SvgPicture& picture, const std::string& caption, const std::string& link = "");
    /// Pictures of one thing that take turns.
    void figures(const std::vector<PageFigure>& figures);
    [[nodiscard]] PageFigure make_figure(const std::string& label, const SvgPicture& picture,
                                         const std::string& caption = "", const std::string& link = "");
    void view(const Scene& scene);
    /// HTML of a small still picture of a surface.
    [[nodiscard]] std::string thumbnail(const ViewMesh& mesh, const std::string& name);

    void check(Invariant invariant) { invariants_.push_back(std::move(invariant)); }
    void failure(const std::string& item, const std::string& stage, const std::string& status,
                 const std::string& message);

    [[nodiscard]] std::size_t count(Verdict verdict) const;
    [[nodiscard]] std::size_t failure_count() const { return failures_.rows.size(); }

    /// A name for links, unlike all others of the page.
    [[nodiscard]] std::string new_link() { return "l" + std::to_string(++links_); }
    /// Bytes of the page so far, about.
    [[nodiscard]] std::size_t size() const { return body_.size() + bytes_.size(); }

    /// The whole page.
    [[nodiscard]] std::string document(const PageOrigin& origin) const;

  private:
    [[nodiscard]] std::string summary_html() const;
    [[nodiscard]] PageTable checks_table(const std::function<bool(Verdict)>& wanted) const;
    [[nodiscard]] std::string invariants_html() const;
    [[nodiscard]] std::string provenance_html(const PageOrigin& origin) const;

    std::string body_, contents_;
    std::vector<Invariant> invariants_;
    PageTable failures_{"", {"item", "stage", "status", "message"}, {}, {}};
    nlohmann::json scenes_ = nlohmann::json::array(), thumbnails_ = nlohmann::json::array();
    ByteStore bytes_;
    int links_ = 0, pictures_ = 0, sections_ = 0;
};

/// A number as tables show it: six digits, an exponent where that is shorter; a dash for NaN.
std::string number_text(double value);

}  // namespace ricci::app
