#include "table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace supple::verify {
namespace {

std::vector<Case>& registry() {
    static std::vector<Case> cases;  // inside a function: exists before the first case registers itself
    return cases;
}

std::string number(double value, int digits) {
    char text[32];
    std::snprintf(text, sizeof text, "%.*g", digits, value);
    return text;
}

/// The columns of a line, as text.
std::vector<std::string> cells(const Line& line) {
    return {std::to_string(line.row),
            line.what,
            line.exact ? number(*line.exact, 7) : "",
            std::isnan(line.ours) ? "" : number(line.ours, 7),
            std::isnan(line.error) ? "" : number(line.error, 2),
            std::isnan(line.tolerance) ? "" : number(line.tolerance, 2),
            line.order ? number(*line.order, 3) : "",
            !line.judged ? "" : line.pass ? "pass" : "FAIL"};
}

const std::vector<std::string> kHeads{"row", "case", "exact", "ours", "error", "tolerance", "order", "result"};

/// Characters shown, not bytes: the cases' names may hold any letters.
std::size_t width_of(const std::string& s) {
    return std::size_t(std::count_if(s.begin(), s.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

}  // namespace

RegisterCase::RegisterCase(Case c) {
    auto& cases = registry();
    const auto place = std::lower_bound(cases.begin(), cases.end(), c, [](const Case& a, const Case& b) {
        return a.row != b.row ? a.row < b.row : a.name < b.name;
    });
    cases.insert(place, std::move(c));
}

const std::vector<Case>& all_cases() { return registry(); }

void Table::add(Line line) {
    line.row = row_;
    line.pass = line.error <= line.tolerance;  // false for NaN
    lines_.push_back(std::move(line));
}

void Table::relative(const std::string& what, double exact, double ours, double tolerance, std::optional<double> order) {
    add({0, what, exact, ours, std::abs(ours - exact) / std::abs(exact), tolerance, order});
}

void Table::absolute(const std::string& what, double exact, double ours, double tolerance, std::optional<double> order) {
    add({0, what, exact, ours, std::abs(ours - exact), tolerance, order});
}

void Table::below(const std::string& what, double ours, double limit, std::optional<double> order) { absolute(what, 0, ours, limit, order); }

void Table::order(const std::string& what, double expected, double ours, double tolerance) {
    add({0, what, expected, ours, std::abs(ours - expected), tolerance, ours});
}

void Table::order_at_least(const std::string& what, double least, double ours) {
    add({0, what, least, ours, std::isnan(ours) ? ours : std::max(0.0, least - ours), 0, ours});
}

void Table::value(const std::string& what, double ours) {
    Line line{row_, what, {}, ours, NAN, NAN, {}};
    line.pass = true;
    line.judged = false;
    lines_.push_back(line);
}

void Table::note(const std::string& text) { notes_.push_back("Row " + std::to_string(row_) + ": " + text); }

void Table::failed(const std::string& what, const std::string& why) {
    add({0, what, {}, NAN, NAN, NAN, {}});
    note(what + ": " + why);
}

bool Table::passes() const {
    return std::all_of(lines_.begin(), lines_.end(), [](const Line& line) { return line.pass; });
}

std::string Table::text() const {
    std::vector<std::vector<std::string>> rows{kHeads};
    for (const Line& line : lines_) rows.push_back(cells(line));
    std::vector<std::size_t> width(kHeads.size(), 0);
    for (const auto& row : rows)
        for (std::size_t c = 0; c < row.size(); ++c) width[c] = std::max(width[c], width_of(row[c]));
    std::string out;
    for (const auto& row : rows) {
        for (std::size_t c = 0; c < row.size(); ++c) {
            const std::string pad(width[c] - width_of(row[c]), ' ');
            const bool left = c == 1 || c + 1 == row.size();
            out += left ? row[c] + (c + 1 < row.size() ? pad : "") : pad + row[c];
            out += c + 1 < row.size() ? "  " : "\n";
        }
    }
    for (const std::string& note : notes_) out += note + "\n";
    return out;
}

std::string Table::markdown() const {
    std::string out = "|";
    for (const std::string& head : kHeads) out += " " + head + " |";
    out += "\n|--:|---|--:|--:|--:|--:|--:|---|\n";
    for (const Line& line : lines_) {
        out += "|";
        for (const std::string& cell : cells(line)) out += " " + cell + " |";
        out += "\n";
    }
    if (!notes_.empty()) out += "\n";
    for (const std::string& note : notes_) out += "* " + note + "\n";
    return out;
}

}  // namespace supple::verify
