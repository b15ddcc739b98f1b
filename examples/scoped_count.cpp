// scoped_count: the thesis's way to keep what a function works on, by counting a copy of a container.
#include <cstdio>
#include <mutex>
#include <slamgc/slamgc.hpp>
#include <thread>

struct KeyFrame : slamgc::rc_object<KeyFrame> {
  explicit KeyFrame(int number) : id(number) {}
  int id;
};

class Map {
 public:
  void add(KeyFrame* keyframe) {
    const std::lock_guard<std::mutex> lock(mutex_);
    keyframes_.push_back(keyframe);
  }
  void clear() {
    const std::lock_guard<std::mutex> lock(mutex_);
    keyframes_.clear();
  }
  int sum_of_ids() {
    std::unique_lock<std::mutex> lock(mutex_);
    const slamgc::scoped_count keyframes(keyframes_.raw());  // counted under the container's lock
    lock.unlock();
    int sum = 0;
    for (KeyFrame* k : keyframes) sum += k->id;  // safe: clear() cannot destroy them now
    return sum;
  }

 private:
  std::mutex mutex_;
  slamgc::rc_vector<KeyFrame> keyframes_;
};

int main() {
  Map map;
  for (int i = 1; i <= 100; ++i) map.add(new KeyFrame(i));
  std::thread other([&map] { map.clear(); });
  const int sum = map.sum_of_ids();
  other.join();
  std::printf("the sum is %d (5050, or 0 if the map was cleared first)\n", sum);
}
