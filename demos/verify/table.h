#pragma once
// The verification suite: cases that register themselves, and the lines they write into one table.
#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace supple::verify {

/// One comparison. `error` is relative where an exact value of size is known, otherwise absolute.
struct Line {
    int row = 0;
    std::string what;
    std::optional<double> exact;
    double ours = 0, error = 0, tolerance = 0;
    std::optional<double> order;  ///< observed order of convergence
    bool pass = false;
    bool judged = true;           ///< false: a value without anything to compare it with
};

/// What a case writes into. Nothing here knows results: every `ours` is computed by the case.
class Table {
public:
    /// |ours - exact| <= tolerance |exact|
    void relative(const std::string& what, double exact, double ours, double tolerance, std::optional<double> order = {});
    /// |ours - exact| <= tolerance
    void absolute(const std::string& what, double exact, double ours, double tolerance, std::optional<double> order = {});
    /// An error that should be zero: |ours| <= limit.
    void below(const std::string& what, double ours, double limit, std::optional<double> order = {});
    /// An order of convergence: |ours - expected| <= tolerance, or only ours >= expected - tolerance.
    void order(const std::string& what, double expected, double ours, double tolerance);
    void order_at_least(const std::string& what, double least, double ours);
    /// A value of ours that nothing stands beside: no verdict.
    void value(const std::string& what, double ours);
    /// A sentence below the table, with the number of the row.
    void note(const std::string& text);
    /// A case that ended before its comparisons.
    void failed(const std::string& what, const std::string& why);

    void begin_row(int row) { row_ = row; }
    const std::vector<Line>& lines() const { return lines_; }
    bool passes() const;

    std::string text() const;      ///< aligned columns for a terminal
    std::string markdown() const;  ///< the table of the README

private:
    void add(Line line);

    int row_ = 0;
    std::vector<Line> lines_;
    std::vector<std::string> notes_;
};

struct Settings {
    bool quick = false;  ///< coarser meshes and fewer samples, where a case has that choice; the tolerances stay
    int threads = 0;
};

/// One case of the suite. Several may share a row.
struct Case {
    int row = 0;
    std::string name;
    bool slow = false;  ///< left out by --quick
    std::function<void(Table&, const Settings&)> run;
};

/// Cases live in the .cpp files of this folder; each registers itself with a `const RegisterCase`.
struct RegisterCase {
    explicit RegisterCase(Case c);
};

const std::vector<Case>& all_cases();  ///< by row; within a row by name

}  // namespace supple::verify
