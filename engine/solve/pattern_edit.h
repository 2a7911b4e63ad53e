#pragma once
#include "supple/base/function_ref.h"
#include "supple/solve/bsr3.h"

namespace supple::solve {

/// How the rows of a pattern go on after its elements have changed in places. Rows and elements that are kept have kept their order.
struct RowChange {
    std::span<const std::int32_t> order;    ///< [row] the vertices, as make_pattern() takes them
    std::span<const std::int32_t> old_row;  ///< [row] what it was, if the elements at it are the same as before; -1: made anew
    std::span<const std::int32_t> new_row;  ///< [old row] what it is now; -1: gone
};

/// The pattern of the changed elements: the same as make_pattern() gives, but only rows that changed are made from elements.
/// @param append  adds the vertices of the elements at one to the list, in any order, repeated or not
Bsr3Pattern change_pattern(const Bsr3Pattern& before, const RowChange& change, FunctionRef<void(std::int32_t vertex, std::vector<std::int32_t>& out)> append);

/// make_gather_map() of the changed elements, all of N corners.
/// @param new_element  [element before] its number now; of those at rows that are kept
/// @param at_vertex    adds the elements now at a vertex to the list, ascending
template <std::size_t N>
GatherMap change_gather_map(const GatherMap& before, const Bsr3Pattern& was, const Bsr3Pattern& is, const RowChange& change, std::span<const std::int32_t> new_element,
                            std::span<const std::array<std::int32_t, N>> elements, FunctionRef<void(std::int32_t vertex, std::vector<std::int32_t>& out)> at_vertex);

}  // namespace supple::solve
