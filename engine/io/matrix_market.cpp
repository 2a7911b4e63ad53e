#include "supple/io/matrix_market.h"

#include <charconv>
#include <vector>

#include "supple/io/binary_file.h"
#include "supple/io/text_scanner.h"

namespace supple::io {

namespace {

void append(std::string& text, double value) {
    char digits[40];
    text.append(digits, std::to_chars(digits, digits + sizeof digits, value, std::chars_format::general, 17).ptr);
}

bool is_symmetric(const Eigen::SparseMatrix<double>& matrix) {
    if (matrix.rows() != matrix.cols()) return false;
    const Eigen::SparseMatrix<double> transposed = matrix.transpose();
    const Eigen::SparseMatrix<double> difference = matrix - transposed;
    for (Eigen::Index k = 0; k < difference.nonZeros(); ++k)
        if (difference.valuePtr()[k] != 0) return false;
    return true;
}

}  // namespace

std::string matrix_market_text(const Eigen::SparseMatrix<double>& given) {
    Eigen::SparseMatrix<double> matrix = given;
    matrix.makeCompressed();
    const bool symmetric = is_symmetric(matrix);
    std::string entries;
    std::size_t count = 0;
    for (Eigen::Index column = 0; column < matrix.outerSize(); ++column) {
        for (Eigen::SparseMatrix<double>::InnerIterator it(matrix, column); it; ++it) {
            if (symmetric && it.row() < it.col()) continue;
            entries += std::to_string(it.row() + 1) + ' ' + std::to_string(it.col() + 1) + ' ';
            append(entries, it.value());
            entries += '\n';
            ++count;
        }
    }
    return std::string("%%MatrixMarket matrix coordinate real ") + (symmetric ? "symmetric\n" : "general\n") + std::to_string(matrix.rows()) + ' ' +
           std::to_string(matrix.cols()) + ' ' + std::to_string(count) + '\n' + entries;
}

void write_matrix_market(const std::filesystem::path& file, const Eigen::SparseMatrix<double>& matrix) { write_text_file(file, matrix_market_text(matrix)); }

Eigen::SparseMatrix<double> read_matrix_market(const std::filesystem::path& file) { return parse_matrix_market(read_text_file(file), file.string()); }

Eigen::SparseMatrix<double> parse_matrix_market(std::string_view text, const std::string& name) {
    TextScanner scanner(text, name);
    if (scanner.word() != "%%MatrixMarket") scanner.fail("is not a Matrix Market file: it must begin with %%MatrixMarket");
    for (const std::string_view wanted : {"matrix", "coordinate", "real"}) {
        const std::string_view word = scanner.word();
        if (word != wanted) scanner.fail("found " + quoted(word) + " where this reader takes \"matrix coordinate real\" only");
    }
    const std::string_view symmetry = scanner.word();
    if (symmetry != "general" && symmetry != "symmetric") scanner.fail("symmetry " + quoted(symmetry) + " is neither general nor symmetric");
    scanner.end_line("the header");
    for (scanner.skip_space(); !scanner.at_end() && *scanner.position() == '%'; scanner.skip_space()) scanner.next_line();
    const std::int64_t rows = scanner.integer("the number of rows", 0, INT32_MAX), columns = scanner.integer("the number of columns", 0, INT32_MAX);
    const std::int64_t count = scanner.integer("the number of entries", 0, INT32_MAX);
    scanner.end_line("the three sizes");
    std::vector<Eigen::Triplet<double>> triplets;
    triplets.reserve(scanner.plausible(count, 6));
    for (std::int64_t k = 0; k < count; ++k) {
        scanner.skip_space();
        const int row = int(scanner.integer("the row", 1, rows)) - 1, column = int(scanner.integer("the column", 1, columns)) - 1;
        const double value = scanner.real("the value");
        scanner.end_line("the value");
        triplets.emplace_back(row, column, value);
        if (symmetry == "symmetric" && row != column) triplets.emplace_back(column, row, value);
    }
    scanner.skip_space();
    if (!scanner.at_end()) scanner.fail("more than the " + std::to_string(count) + " entries that the header says");
    Eigen::SparseMatrix<double> matrix{Eigen::Index(rows), Eigen::Index(columns)};
    matrix.setFromTriplets(triplets.begin(), triplets.end());
    return matrix;
}

}  // namespace supple::io
