// Names against the rules, for clang_tidy_rejects_bad_names.sh; never compiled.
struct bad_type {};
enum class Choice { badEnumerator, kGoodEnumerator };
constexpr int bad_constant = 1;
constexpr int kGoodConstant = 2;
constexpr int kGood_ns = 3;

class GoodType {
 public:
  int BadFunction() const { return member; }
  int goodFunction() const { return good_member_; }

 private:
  int member = 0;
  int good_member_ = 0;
};

int goodFunction(int good_variable) {
  int BadVariable = good_variable;
  return BadVariable + bad_constant + kGoodConstant + kGood_ns;
}
