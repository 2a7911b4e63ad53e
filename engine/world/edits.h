#pragma once
#include <deque>

#include "supple/base/byte_stream.h"
#include "supple/world/impl.h"

namespace supple {

/// What a host has made of a body, without what moves.
struct BodyModel {
    BodyDef def;
    std::vector<std::int32_t> owner;
    std::vector<Motion> motions;
    PreparedLoads loads;
};

/// Which vertices and elements of the body as it was added the present ones are.
struct EditIdentity {
    std::vector<std::uint32_t> vertex_id, element_id;
    std::uint32_t next_vertex_id = 0, next_element_id = 0;
    TopologyDelta from_origin;
};

/// The edits of one body.
struct BodyEdits {
    struct Step {
        BodyModel model;
        BodyState state, start;
        EditIdentity identity;  ///< before the edit
        TopologyDelta delta;
    };
    std::shared_ptr<const BodyModel> origin;  ///< before the first edit
    EditIdentity identity;
    std::uint64_t count = 0;
    std::deque<Step> undo;
};

inline constexpr std::size_t kUndoDepth = 8;

BodyModel model_of(const Body& body);
EditIdentity unedited(const Body& body);

/// Drags and attachments of a body follow an edit of it. `x_before`: positions before.
void move_touch(World::Impl& world, BodyId id, const TopologyDelta& delta, const std::vector<Vec3>& x_before);

/// Puts a body in the place of another, with what belongs to the world around it.
void replace_body(World::Impl& world, BodyId id, std::unique_ptr<Body> body);

/// Velocities so that every piece of `to` has the angular momentum of its parts in `from`: lumping the masses of cut elements anew loses some.
void conserve_spin(const Body& from, Body& to, const TopologyDelta& delta);

/// Edits in a snapshot: nothing but a zero for a body that has none.
void write_edits(ByteWriter& out, const Body& body);
/// Reads them; `sealed`: the snapshot's bytes are as they were saved, otherwise nothing is built of them. Where they are not those of the body: the body of this snapshot's edits, to be put in its place; otherwise null.
std::unique_ptr<Body> read_edits(ByteReader& in, bool sealed, const Body& body, const WorldDef& world, Isa isa);

}  // namespace supple
