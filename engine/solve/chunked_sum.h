#pragma once
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

}  // namespace supple::solve
