#pragma once
#include "supple/mesh/mesh_edit.h"
#include "supple/mesh/surface.h"

namespace supple {

/// What an edit left as it was, so that what was made of the mesh before can be taken over instead of made anew.
struct EditTrace {
    std::vector<std::int32_t> old_vertex;   ///< [new vertex] the old one that it is, if every element at it is the same, and no other; else -1
    std::vector<std::int32_t> new_vertex;   ///< [old vertex] what it is now, whatever became of the elements at it; -1: gone, or merged into one before it
    std::vector<std::int32_t> old_element;  ///< [new element] the old one with the same vertices at the same rest positions; else -1
    std::vector<std::int32_t> new_element;  ///< [old element] the reverse
    bool ordered = true;                    ///< what is kept has kept its order: else nothing can be taken over
};

/// O(n), no sorting.
EditTrace trace_edit(const VolumeMesh& before, const VolumeMesh& after, const TopologyDelta& delta);

/// extract_boundary(after), found from the boundary before: the same to the last index. O(n), sorts only where the edit was.
/// @pre trace.ordered
BoundarySurface follow_boundary(const BoundarySurface& was, const VolumeMesh& after, const EditTrace& trace);

}  // namespace supple
