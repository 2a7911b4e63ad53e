// Which bodies are solved together.
#include "supple/world/island.h"

#include "supple/world/impl.h"

namespace supple {

void form_islands(World::Impl& world) {
    const std::vector<Member>& active = world.active;
    DisjointSets& sets = world.together;
    std::vector<std::size_t>& first_at = world.first_at_collider;
    sets.reset(active.size());
    for (std::size_t i = 0; i < active.size(); ++i) active[i].body->work.place = i;
    first_at.assign(world.colliders.size(), active.size());
    for (std::size_t i = 0; i < active.size(); ++i) {
        for (const Contact& c : active[i].body->contacts.list) {
            if (c.other != nullptr) {
                sets.join(i, c.other->work.place);
            } else if (c.collider != kNoCollider && world.colliders[c.collider].unknown()) {
                std::size_t& first = first_at[c.collider];
                if (first == active.size()) first = i;
                sets.join(i, first);
            }
        }
    }
    world.living_islands = 0;
    std::vector<std::size_t>& island = first_at;  // [root] its island; the colliders are done with
    island.assign(active.size(), 0);
    for (std::size_t i = 0; i < active.size(); ++i) {
        const std::size_t root = sets.root(i);
        if (root == i) {  // the first of its members
            island[i] = world.living_islands++;
            if (world.islands.size() < world.living_islands) world.islands.emplace_back();
            Island& fresh = world.islands[island[i]];
            fresh.rows = fresh.elements = 0;
            fresh.members.clear();
        }
        Island& home = world.islands[island[root]];
        home.members.push_back(active[i]);
        active[i].body->work.first_row = home.rows;
        home.rows += active[i].body->vertices();
        home.elements += active[i].body->element_count();
    }
}

}  // namespace supple
