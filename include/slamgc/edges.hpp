/// @file
/// Describing the edges of an object: what a collector needs to know to find cycles.
///
/// ```
/// struct KeyFrame : slamgc::rc_object<KeyFrame, slamgc::fetch_add_counter, slamgc::reclaim_retired> {
///   template <class Visitor>
///   void edges(Visitor& v) {
///     {
///       const std::lock_guard<std::mutex> lock(mMutexFeatures);
///       v.edge("mvpMapPoints", mvpMapPoints, slamgc::on_retire::null);
///     }
///     const std::lock_guard<std::mutex> lock(mMutexConnections);
///     v.edge("mpParent", mpParent);
///     for (auto& list : mvGrid) v.edge("mvGrid", list);
///   }
/// ```
///
/// One function per type names each counted member once. It takes the program's own locks, since other threads may
/// change the members meanwhile; it may be called on any thread that collects, at any time while the object exists; it
/// must not change, count or destroy anything itself. It should not throw: while it does, the object and what it refers to
/// live on. Edges do not lead into another domain. collect() must not be called under a lock that an edges() takes. A member
/// that is left out, or named twice, makes objects live on that nobody needs; it never makes one die too early.
///
/// The third argument is what becomes of the edge when its target is retired (dispositions.hpp); what is not an object but
/// holds counted references describes them in the same way (root.hpp).
#pragma once

#include "detail/described.hpp"
#include "dispositions.hpp"
