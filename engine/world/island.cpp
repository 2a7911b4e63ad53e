// Which bodies are solved together.
#include "supple/world/island.h"

#include <numeric>

#include "supple/world/impl.h"

namespace supple {

namespace {

/// The smallest member of the set that i is in; on the way, sets become flatter.
std::size_t root_of(std::vector<std::size_t>& parent, std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

void join(std::vector<std::size_t>& parent, std::size_t a, std::size_t b) {
    a = root_of(parent, a);
    b = root_of(parent, b);
    parent[std::max(a, b)] = std::min(a, b);
}

}  // namespace

void form_islands(World::Impl& world) {
    const std::vector<Member>& active = world.active;
    std::vector<std::size_t>& parent = world.island_of;
    std::vector<std::size_t>& first_at = world.first_at_collider;
    parent.resize(active.size());
    std::iota(parent.begin(), parent.end(), std::size_t{0});
    first_at.assign(world.colliders.size(), active.size());
    for (std::size_t i = 0; i < active.size(); ++i) {
        for (const Contact& c : active[i].body->contacts.list) {
            if (c.other != nullptr) {
                for (std::size_t j = 0; j < active.size(); ++j) {
                    if (active[j].body == c.other) join(parent, i, j);
                }
            } else if (c.collider != kNoCollider && world.colliders[c.collider].unknown()) {
                std::size_t& first = first_at[c.collider];
                if (first == active.size()) first = i;
                join(parent, i, first);
            }
        }
    }
    world.living_islands = 0;
    std::vector<std::size_t>& island = first_at;  // [root] its island; the colliders are done with
    island.assign(active.size(), 0);
    for (std::size_t i = 0; i < active.size(); ++i) {
        const std::size_t root = root_of(parent, i);
        if (root == i) {  // the first of its members
            island[i] = world.living_islands++;
            if (world.islands.size() < world.living_islands) world.islands.emplace_back();
            Island& fresh = world.islands[island[i]];
            fresh.rows = fresh.elements = 0;
            fresh.members.clear();
        }
        Island& home = world.islands[island[root]];
        home.members.push_back({active[i].id, active[i].body, home.rows});
        home.rows += active[i].body->vertices();
        home.elements += active[i].body->element_count();
    }
}

}  // namespace supple
