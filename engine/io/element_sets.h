#pragma once
#include <map>
#include <string>
#include <vector>

#include "supple/io/mesh_builder.h"

namespace supple::io {

/// Elements that are told before the sets they belong to.
class ElementSets {
public:
    void add_element(std::int64_t id, const ElementType& type, std::span<const std::int64_t> vertices, const TextScanner& scanner,
                     const char* position);
    /// The set of this name, made if it is not there.
    std::vector<std::int64_t>& set(const std::string& name);
    bool has_set(const std::string& name) const { return index_.contains(name); }
    std::size_t element_count() const { return elements_.size(); }

    /// Adds all elements. A set that `region_order` names becomes a region, the first that holds an element wins; without any, all sets are
    /// regions in their order. Further sets of an element become vertex groups.
    /// @error Error(parse) where an element's number stands twice, or a set holds one that is not there
    void feed(const TextScanner& scanner, const std::vector<std::string>& region_order, MeshBuilder& builder);

private:
    struct Element {
        std::int64_t id;
        const ElementType* type;
        std::size_t begin;
        const TextScanner* scanner;
        const char* position;
    };
    std::vector<Element> elements_;
    std::vector<std::int64_t> vertices_;
    std::vector<std::pair<std::string, std::vector<std::int64_t>>> sets_;
    std::map<std::string, std::size_t> index_;
};

}  // namespace supple::io
