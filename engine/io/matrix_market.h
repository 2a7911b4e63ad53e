#pragma once
#include <Eigen/SparseCore>
#include <filesystem>
#include <string>
#include <string_view>

namespace supple::io {

/// A sparse matrix in the Matrix Market exchange format (R. Boisvert, R. Pozo, K. Remington, NISTIR 5935, 1996): coordinate real, `symmetric` with its lower
/// triangle where it is so to the last bit, else `general`; 17 digits, so that read_matrix_market() gives the same bits back.
std::string matrix_market_text(const Eigen::SparseMatrix<double>& matrix);
void write_matrix_market(const std::filesystem::path& file, const Eigen::SparseMatrix<double>& matrix);

/// Reads `matrix coordinate real general|symmetric`; entries of one place add up.
/// @error Error(parse) at "file:line"; Error(file_unreadable)
Eigen::SparseMatrix<double> read_matrix_market(const std::filesystem::path& file);
Eigen::SparseMatrix<double> parse_matrix_market(std::string_view text, const std::string& name);

}  // namespace supple::io
