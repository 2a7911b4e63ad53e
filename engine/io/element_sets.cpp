#include "supple/io/element_sets.h"

#include <algorithm>

namespace supple::io {

void ElementSets::add_element(std::int64_t id, const ElementType& type, std::span<const std::int64_t> vertices, const TextScanner& scanner,
                              const char* position) {
    elements_.push_back({id, &type, vertices_.size(), &scanner, position});
    vertices_.insert(vertices_.end(), vertices.begin(), vertices.end());
}

std::vector<std::int64_t>& ElementSets::set(const std::string& name) {
    const auto [entry, is_new] = index_.try_emplace(name, sets_.size());
    if (is_new) sets_.emplace_back(name, std::vector<std::int64_t>());
    return sets_[entry->second].second;
}

void ElementSets::feed(const TextScanner& scanner, const std::vector<std::string>& region_order, MeshBuilder& builder) {
    std::vector<std::pair<std::int64_t, std::size_t>> by_id;
    for (std::size_t e = 0; e < elements_.size(); ++e) by_id.emplace_back(elements_[e].id, e);
    std::sort(by_id.begin(), by_id.end());
    for (std::size_t i = 1; i < by_id.size(); ++i)
        if (by_id[i].first == by_id[i - 1].first) {
            const Element& again = elements_[by_id[i].second];
            again.scanner->fail("element " + std::to_string(again.id) + " is defined a second time", again.position);
        }

    // Regions first, so that they come first among the tags of an element.
    std::vector<std::size_t> order;
    std::vector<char> taken(sets_.size(), 0);
    for (const std::string& name : region_order) {
        const auto found = index_.find(name);
        if (found == index_.end() || taken[found->second]) continue;
        taken[found->second] = 1;
        order.push_back(found->second);
    }
    for (std::size_t s = 0; s < sets_.size(); ++s)
        if (!taken[s]) order.push_back(s);

    // Tag s + 1 is set s.
    std::vector<std::pair<std::size_t, std::int64_t>> pairs;  // element, tag
    for (const std::size_t s : order) {
        builder.name_group(3, std::int64_t(s) + 1, sets_[s].first);
        std::vector<std::int64_t>& members = sets_[s].second;
        std::sort(members.begin(), members.end());
        members.erase(std::unique(members.begin(), members.end()), members.end());
        for (const std::int64_t id : members) {
            const auto found = std::lower_bound(by_id.begin(), by_id.end(), std::pair(id, std::size_t(0)));
            if (found == by_id.end() || found->first != id)
                throw Error(
                    ErrorCode::parse, scanner.name(),
                    "the set " + io::quoted(sets_[s].first) + " holds element " + std::to_string(id) + ", which the file does not define");
            pairs.emplace_back(found->second, std::int64_t(s) + 1);
        }
    }
    std::stable_sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) { return a.first < b.first; });

    std::size_t at = 0;
    std::vector<std::int64_t> tags;
    for (std::size_t e = 0; e < elements_.size(); ++e) {
        tags.clear();
        for (; at < pairs.size() && pairs[at].first == e; ++at)
            if (std::find(tags.begin(), tags.end(), pairs[at].second) == tags.end()) tags.push_back(pairs[at].second);
        const Element& element = elements_[e];
        builder.add_element(*element.scanner, element.position, *element.type,
                            {vertices_.data() + element.begin, std::size_t(element.type->vertex_count)}, tags);
    }
}

}  // namespace supple::io
