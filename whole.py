from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
class Whole(JITCodeLibrary):
    def _optimize_final_module(self):
        n=0
        for f in self._final_module.functions:
            if not f.is_declaration and f.linkage.name in ('linkonce_odr',):
                f.linkage='internal'; n+=1
        import time; t=time.time()
        super()._optimize_final_module()
        print('whole',n,time.time()-t,flush=True)
class Program(Compiler):
    def __init__(self, typingctx, targetctx, library, *rest):
        if library is None:
            library=Whole(targetctx.codegen(),'whole')
        super().__init__(typingctx,targetctx,library,*rest)
