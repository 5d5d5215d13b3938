WIDTHS={}
class JournalWidth: pass
