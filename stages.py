import sys,time; sys.path.insert(0,'/tmp/w/scratch_batch'); sys.argv=['x','4']
import numpy as np, numba
exec(open('/tmp/w/scratch_batch/rate.py').read().split('full_cycles(designs(0')[0])
from bare import bare
import stepwell.statics.batch as B
from stepwell.kernels.machine import machine
mb,mp,mg,mf=[machine(getattr(x,'function',x)) for x in (B._build,B._problem,B._begin,B.follow)]
cut=machine(B.cut_into); 
@numba.njit(nogil=True,error_model='numpy')
def A0(designs,work,m):
    d=bare(designs); w=bare(work)
    for k in range(m): mb(d,k,w)
@numba.njit(nogil=True,error_model='numpy')
def A1(designs,work,m):
    d=bare(designs); w=bare(work)
    for k in range(m):
        mb(d,k,w); cut(w.laws,w.sheets,w.pieces,w.room)
@numba.njit(nogil=True,error_model='numpy')
def A(designs,work,m):
    d=bare(designs); w=bare(work)
    for k in range(m):
        mb(d,k,w); p=mp(d,k,w); mg(d,p,w)
@numba.njit(nogil=True,error_model='numpy')
def C(designs,work,m):
    d=bare(designs); w=bare(work)
    for k in range(m):
        mb(d,k,w); p=mp(d,k,w); mg(d,p,w)
        w.effort[0]=0; w.effort[1]=10**6
        mf(p,w.turning,w.state)
for n in (2,4):
    ds=[designs(s,n,1000) for s in range(40)]; ws=[B._work(d) for d in ds]
    for f in (A0,A1,A,C):
        f(ds[0],ws[0],2)
        t=time.process_time()
        for d,w in zip(ds,ws): f(d,w,1000)
        print(n,f.__name__,(time.process_time()-t)/40000*1e6, flush=True)
    o=B.Followed(np.full((1000,40),-1),np.full((1000,8),np.nan))
    t=time.process_time()
    for d,w in zip(ds,ws): B.follow_each(d,0,1000,w,o)
    print(n,'all',(time.process_time()-t)/40000*1e6, flush=True)
