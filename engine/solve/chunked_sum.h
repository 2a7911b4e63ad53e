#pragma once
#include <span>
#include <vector>

#include "supple/base/parallel.h"
#include "supple/solve/bsr3.h"

namespace supple::solve {

/// Number of fixed chunks of a loop over rows.
inline std::size_t row_chunks(std::size_t rows) { return (rows + kRowChunk - 1) / kRowChunk; }

/// Sum of part(begin, end) over fixed chunks of rows, added in chunk order: the same bits for every team.
template <class Part>
double sum_over_rows(Team& team, std::size_t rows, std::vector<double>& partial, Part&& part) {
    team.for_chunks(row_chunks(rows), [&](std::size_t chunk) {
        const std::size_t begin = chunk * kRowChunk;
        partial[chunk] = part(begin, begin + kRowChunk < rows ? begin + kRowChunk : rows);
    });
    double sum = 0;
    for (std::size_t chunk = 0; chunk < row_chunks(rows); ++chunk) sum += partial[chunk];
    return sum;
}

/// Rows [begin, end) of one of the parts of a system.
struct RowPiece {
    std::size_t part = 0, begin = 0, end = 0;
};

/// The fixed chunks of all parts, in their order: many small parts are one loop.
template <class Part, class Rows>
void cut_rows(std::span<const Part> parts, Rows&& rows_of, std::vector<RowPiece>& pieces) {
    pieces.clear();
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const std::size_t rows = rows_of(parts[p]);
        for (std::size_t begin = 0; begin < rows; begin += kRowChunk) pieces.push_back({p, begin, begin + kRowChunk < rows ? begin + kRowChunk : rows});
    }
}

/// Sum of part(piece), added in their order.
template <class Part>
double sum_over_pieces(Team& team, std::span<const RowPiece> pieces, std::vector<double>& partial, Part&& part) {
    team.for_chunks(pieces.size(), [&](std::size_t i) { partial[i] = part(pieces[i]); });
    double sum = 0;
    for (std::size_t i = 0; i < pieces.size(); ++i) sum += partial[i];
    return sum;
}

}  // namespace supple::solve
