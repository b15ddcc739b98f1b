// Every member of every class template, whether a test calls it or not. Only in the coverage lane:
// a member that no test instantiates is no code, and would not count as uncovered.
#include <slamgc/slamgc.hpp>

namespace {
struct node : slamgc::rc_object<node> {};
}  // namespace

namespace slamgc {

template class intrusive_rc<node>;
template class rc_slot<node>;
template class rc_vector<node>;
template class rc_list<node>;
template class rc_set<node>;
template class rc_map<node, int>;
template class rc_value_map<int, node>;
template class rc_unordered_set<node>;
template class rc_unordered_map<node, int>;

namespace detail {
template class counted_container<node, std::vector<node*>, element_itself,
                                 std::vector<node*>::const_iterator>;
template class counted_associative<rc_set<node>, node, std::set<node*>, element_itself>;
template class edit_scope<node, std::vector<node*>, element_itself>;
template class element_ref<node>;
}  // namespace detail

}  // namespace slamgc
